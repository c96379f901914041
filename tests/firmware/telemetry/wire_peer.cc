// clang-format off
/// wire_peer talk|listen: one end of the wire, for tests with processes and network namespaces.
///
///   talk    sends PlannerCycle 1, 2, ... on rt/stilt/planner, 200 per second, until it is ended
///   listen  takes them until --count have come or --seconds have passed; prints first, last, received, how many
///           were missing in between, and how many of those were sent later than kJoining after the first came
// clang-format on

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <thread>

#include "firmware/telemetry/reader.h"
#include "firmware/telemetry/writer.h"

namespace {

using namespace stilt::telemetry;
using namespace std::chrono_literals;

using Clock = std::chrono::steady_clock;

/// What was sent later than this after the first sample came is no history any more.
constexpr double kJoining_s = 2.0;

volatile std::sig_atomic_t ended = 0;

/// On a clock that all processes of a machine share.
double now_s() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

int talk(const Participant& participant) {
  auto writer = AnyWriter::open(participant, kPlannerCycles);
  if (!writer) return 2;
  PlannerCycle cycle{};
  for (cycle.cycle = 1; ended == 0; ++cycle.cycle) {
    cycle.time_s = now_s();
    writer->write(&cycle);
    std::this_thread::sleep_for(5ms);
  }
  return 0;
}

int listen(const Participant& participant, unsigned long long count, double seconds) {
  auto reader = Reader::open(participant, kPlannerCycles);
  if (!reader) return 2;
  unsigned long long first = 0, last = 0, received = 0, missing = 0, missing_live = 0;
  double joined_s = 0;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (received < count && Clock::now() < end) {
    reader->take([&](Sample&& sample) {
      const auto cycle = sample.as<PlannerCycle>();
      if (cycle == nullptr) return;
      if (received++ == 0) {
        first = cycle->cycle;
        joined_s = now_s();
      } else if (cycle->cycle > last + 1) {
        missing += cycle->cycle - last - 1;
        if (cycle->time_s > joined_s + kJoining_s) missing_live += cycle->cycle - last - 1;
      }
      last = cycle->cycle;
    });
    std::this_thread::sleep_for(5ms);
  }
  std::printf(
      "{\"first\": %llu, \"last\": %llu, \"received\": %llu, \"missing\": %llu, \"missing_live\": %llu}\n",
      first, last, received, missing, missing_live);
  return 0;
}

int run(int argc, char** argv) {
  CLI::App app;
  Network network;
  unsigned long long samples = 100;
  double seconds = 60;
  app.add_option("--domain", network.domain);
  app.add_option("--interface", network.interface);
  app.add_option("--peers", network.peers);
  app.add_option("--security", network.security_folder);
  app.add_option("--loss", network.lost_permille);
  app.add_option("--count", samples);
  app.add_option("--seconds", seconds);
  app.require_subcommand(1);
  app.fallthrough();
  CLI::App* talking = app.add_subcommand("talk");
  app.add_subcommand("listen");
  CLI11_PARSE(app, argc, argv);
  std::signal(SIGTERM, [](int) { ended = 1; });
  const auto participant = Participant::open(network);
  if (!participant) {
    std::fprintf(stderr, "%s\n", participant.error().c_str());
    return 2;
  }
  return talking->parsed() ? talk(*participant) : listen(*participant, samples, seconds);
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
