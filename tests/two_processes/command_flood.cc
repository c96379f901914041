// command_flood: a client with the run of stiltd but without its token, which sends commands as fast as it
// can until it is ended. Prints "flooding" once the robot listens, and at the end on standard error how many
// were sent.

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>

#include "firmware/telemetry/command_kind.h"
#include "firmware/telemetry/writer.h"
#include "host_tools/telemetry/listener.h"

namespace {

using namespace stilt;
using telemetry::CommandKind;

volatile std::sig_atomic_t ended = 0;

std::uint64_t run_of_robot(const telemetry::Participant& participant) {
  const telemetry::Topic* const topics[] = {&telemetry::kConfiguration};
  host_telemetry::Listener listener(participant, topics);
  std::uint64_t run_id = 0;
  while (run_id == 0 && ended == 0) {
    static_cast<void>(listener.wait(std::chrono::milliseconds(50)));
    listener.take([&](telemetry::Sample&& sample) {
      if (const auto message = sample.as<telemetry::ActiveConfiguration>()) run_id = message->run_id;
    });
  }
  return run_id;
}

int flood(const telemetry::Network& network, std::string name) {
  constexpr CommandKind kKinds[] = {CommandKind::heartbeat, CommandKind::sit, CommandKind::stop,
                                    CommandKind::walk, CommandKind::off};
  const telemetry::Participant participant = host_telemetry::join(network);
  auto writer = telemetry::AnyWriter::open(participant, telemetry::kCommands);
  if (!writer) throw std::runtime_error(writer.error());
  std::string token = "a-guess-0000000000", key;
  telemetry::Command command{};
  command.run_id = run_of_robot(participant);
  command.token = token.data();
  command.commander = name.data();
  command.key = key.data();
  while (writer->subscribers() == 0 && ended == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::puts("flooding");
  std::fflush(stdout);
  for (command.number = 1'000'000; ended == 0; ++command.number) {
    command.kind = static_cast<std::uint8_t>(kKinds[command.number % std::size(kKinds)]);
    writer->write(&command);
  }
  std::fprintf(stderr, "{\"sent\": %llu}\n", static_cast<unsigned long long>(command.number - 1'000'000));
  return 0;
}

int run(int argc, char** argv) {
  CLI::App app;
  telemetry::Network network;
  std::string name = "intruder";
  app.add_option("--domain", network.domain);
  app.add_option("--name", name);
  CLI11_PARSE(app, argc, argv);
  std::signal(SIGTERM, [](int) { ended = 1; });
  return flood(network, name);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
