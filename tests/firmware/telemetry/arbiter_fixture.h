#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "firmware/telemetry/command_arbiter.h"

namespace stilt::telemetry {

inline constexpr std::int64_t kSecond_ns = 1'000'000'000;

class CommandArbiterTest : public testing::Test {
 protected:
  static ArbiterRules rules() {
    return {.run_id = 77,
            .token = "secret",
            .token_file = "/run/token",
            .speed_limit_m_s = 0.8,
            .supervisor = {.heartbeat_timeout_s = 0.4},
            .release_s = 2.0,
            .cmd_vel = true};
  }

  Asked asked(CommandKind kind, double value = 0, const std::string& commander = "anna") {
    return {77, "secret", commander, ++number, static_cast<std::uint8_t>(kind), value, ""};
  }
  Answer take(const Asked& command) { return arbiter.take(command, now); }
  Answer take(CommandKind kind, double value = 0, const std::string& commander = "anna") {
    return take(asked(kind, value, commander));
  }
  control_loop::OperatorCommand command() { return arbiter.command(script, now); }
  void pass(double seconds) {
    now.wall_ns += std::llround(seconds * 1e9);
    now.clock_ns += std::llround(seconds * 1e9);
  }

  std::vector<std::pair<std::string, double>> tunables;
  std::string tunable_answer;
  CommandArbiter arbiter{rules(), [this](const std::string& key, double value) {
                           tunables.emplace_back(key, value);
                           return tunable_answer;
                         }};
  RobotNow now{.clock_ns = 5 * kSecond_ns,
               .wall_ns = 900 * kSecond_ns,
               .state = supervisor::State::stand,
               .present = {},
               .latched = {}};
  control_loop::OperatorCommand script;
  std::uint64_t number = 0;
};

}  // namespace stilt::telemetry
