#include "host_tools/telemetry/commander.h"

#include <cstdio>
#include <random>
#include <stdexcept>
#include <utility>

#include "firmware/telemetry/secret.h"

namespace stilt::host_telemetry {

Commander::Commander(const telemetry::Participant& participant, std::string name) : name_(std::move(name)) {
  auto writer = telemetry::AnyWriter::open(participant, telemetry::kCommands);
  if (!writer) throw std::runtime_error(writer.error());
  writer_ = telemetry::Writer<telemetry::Command>(std::move(*writer));
}

void Commander::set_run(std::uint64_t run_id, std::string token) {
  run_id_ = run_id;
  token_ = std::move(token);
}

std::uint64_t Commander::send(telemetry::CommandKind kind, double value, const std::string& key) {
  std::string its_key = key;
  ++number_;
  std::string proven =
      telemetry::proof(token_, {run_id_, name_, number_, static_cast<std::uint8_t>(kind), value, key});
  telemetry::Command command{};
  command.run_id = run_id_;
  command.token = proven.data();
  command.commander = name_.data();
  command.number = number_;
  command.kind = static_cast<std::uint8_t>(kind);
  command.value = value;
  command.key = its_key.data();
  writer_.write(command);
  return number_;
}

void Commander::heartbeat() {
  constexpr auto kApart = std::chrono::milliseconds(20);
  const auto now = std::chrono::steady_clock::now();
  if (now - heartbeat_ < kApart) return;
  heartbeat_ = now;
  send(telemetry::CommandKind::heartbeat);
}

std::string unique_name(const std::string& prefix) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "-%06x", std::random_device{}() & 0xffffffu);
  return prefix + digits;
}

}  // namespace stilt::host_telemetry
