#include "firmware/program/self_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

namespace stilt::program {
namespace {

/// A robot and a computer with nothing wrong: 1000 ticks.
SelfTestResult good() {
  SelfTestResult result;
  result.ticks = 1000;
  result.commands.fill(1000);
  result.answered.fill(1000);
  result.in_time.fill(1000);
  result.base_readings = 1000;
  result.last.joints[1].position_rad = 0.25;
  result.last.joints[1].driver_temperature_C = 31;
  result.last.joints[1].supply_V = 47.5;
  result.last.base.pitch_rad = 0.01;
  result.last.base.pitch_rate_rad_s = 0.0;
  result.last.emergency_stop = hal::EmergencyStopState::released;
  for (int i = 0; i < 100; ++i) {
    result.wakeup_latency.add_ns(20'000);
    result.solve.add_ns(1'000'000);
  }
  result.idle = realtime::IdleState{"C1", 2.0};
  result.throttled = 0;
  return result;
}

/// Names of the checks that fail.
std::vector<std::string> failed(const SelfTestResult& result) {
  std::vector<std::string> names;
  for (const Check& check : result.checks()) {
    if (!check.passed) names.push_back(check.name);
  }
  return names;
}

TEST(SelfTest, PassesWithNothingWrong) {
  EXPECT_EQ(failed(good()), std::vector<std::string>{});
  EXPECT_TRUE(good().passed());
  EXPECT_NE(to_text(good()).find("\npassed\n"), std::string::npos);
  EXPECT_NE(to_text(good()).find("knee_L at 0.250 rad, driver 31.000 C, supply 47.500 V\n"),
            std::string::npos)
      << to_text(good());
  const nlohmann::json json = nlohmann::json::parse(to_json(good()));
  EXPECT_EQ(json.at("position_rad").at("knee_L"), 0.25);
  EXPECT_EQ(json.at("base_pitch_rad"), 0.01);
  EXPECT_EQ(good().checks().size(), 13u);
}

TEST(SelfTest, EachDefectFailsItsOwnCheckAlone) {
  const std::pair<const char*, std::function<void(SelfTestResult&)>> rows[] = {
      {"knee_L", [](SelfTestResult& r) { r.answered[1] = 998; }},
      {"knee_L", [](SelfTestResult& r) { r.in_time[1] = 989; }},
      {"hip_R", [](SelfTestResult& r) { r.fault[2] = hal::DriverFault::encoder; }},
      {"torso sensor", [](SelfTestResult& r) { r.base_silent_ticks = 21; }},
      {"torso sensor", [](SelfTestResult& r) { r.last.base.pitch_rad = NAN; }},
      {"emergency stop", [](SelfTestResult& r) { r.emergency_stop_pressed = true; }},
      {"emergency stop", [](SelfTestResult& r) { r.emergency_stop_silent = true; }},
      {"emergency stop", [](SelfTestResult& r) { r.last.emergency_stop = hal::EmergencyStopState::absent; }},
      {"heat and supply", [](SelfTestResult& r) { r.limit_trouble = "hip_R is at 95 C"; }},
      {"bus errors", [](SelfTestResult& r) { r.bus_errors = 5; }},
      {"wake-up", [](SelfTestResult& r) { r.late_ticks = 2; }},
      {"planner", [](SelfTestResult& r) { r.limits.plan_period_s = 0.9e-3; }},
      {"idle states", [](SelfTestResult& r) { r.idle->exit_us = 501.0; }},
      {"interrupts", [](SelfTestResult& r) { r.interrupts.push_back({"irq/45-can0", 117, 50, "0-3"}); }},
      {"throttling", [](SelfTestResult& r) { r.throttled = 1; }},
  };
  for (const auto& [name, spoil] : rows) {
    SelfTestResult result = good();
    spoil(result);
    EXPECT_EQ(failed(result), std::vector<std::string>{name});
    EXPECT_FALSE(result.passed()) << name;
    const std::string text = to_text(result);
    EXPECT_NE(text.find("FAILED  " + std::string(name)), std::string::npos) << text;
    EXPECT_FALSE(nlohmann::json::parse(to_json(result)).at("passed").get<bool>()) << name;
  }
}

TEST(SelfTest, AnAbsentEmergencyStopPassesOnlyWhereThatIsAcceptedAndIsReported) {
  SelfTestResult result = good();
  result.last.emergency_stop = hal::EmergencyStopState::absent;
  EXPECT_NE(to_text(result).find("--accept-missing-stop"), std::string::npos) << "what would be right";
  result.limits.accept_missing_stop = true;
  EXPECT_TRUE(result.passed()) << to_text(result);
  EXPECT_NE(to_text(result).find("not wired to this program, accepted"), std::string::npos);
  result.emergency_stop_pressed = true;
  EXPECT_FALSE(result.passed());
  result.emergency_stop_pressed = false;
  result.emergency_stop_silent = true;
  EXPECT_FALSE(result.passed());
}

/// Of a torso that leans forward by 0.3 rad.
TEST(SelfTest, LegsThatHangArePlumbOrTheirOffsetsAreWrong) {
  SelfTestResult result = good();
  const double hanging_rad[] = {-0.3, 0.0, -0.3, 0.1};
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    result.last.joints[joint].position_rad = hanging_rad[joint];
  }
  result.last.base.pitch_rad = 0.3;
  result.limits.hangs = true;
  EXPECT_TRUE(result.passed()) << to_text(result);
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    SelfTestResult turned = result;
    turned.last.joints[joint].position_rad += 0.4;
    EXPECT_EQ(failed(turned), std::vector<std::string>{"plumb"}) << joint;
    turned.limits.hangs = false;
    EXPECT_TRUE(turned.passed()) << "a robot that stands";
  }
  SelfTestResult leaning = result;
  leaning.last.base.pitch_rad = 0.0;
  EXPECT_EQ(failed(leaning), std::vector<std::string>{"plumb"}) << "both hips by one turn";
  leaning.last.joints[1].position_rad = NAN;
  EXPECT_EQ(failed(leaning), std::vector<std::string>{"plumb"});
}

TEST(SelfTest, IdleStatesThatAreNotUsedPass) {
  SelfTestResult result = good();
  result.idle = realtime::IdleState{"C10", 890.0};
  result.idle_held_us = 10.0;
  EXPECT_TRUE(result.passed()) << to_text(result);
  EXPECT_NE(to_text(result).find("C10, 890 us to wake, not used: held at 10 us"), std::string::npos);
  result.idle_held_us = 600.0;
  EXPECT_EQ(failed(result), std::vector<std::string>{"idle states"});
}

TEST(SelfTest, InterruptThreadsOfTheBusesAreNamed) {
  SelfTestResult result = good();
  EXPECT_NE(to_text(result).find("no bus has an adapter"), std::string::npos);
  result.interrupt_sentences = {"can0 (spi0.0): no interrupt thread is known"};
  EXPECT_NE(to_text(result).find("can0 (spi0.0): no interrupt thread is known"), std::string::npos);
}

TEST(SelfTest, LimitsThatAreJustKeptPass) {
  SelfTestResult result = good();
  result.answered[1] = 999;
  result.in_time[1] = 990;
  result.base_silent_ticks = 20;
  result.bus_errors = 4;
  result.late_ticks = 1;
  result.idle->exit_us = 500.0;
  EXPECT_TRUE(result.passed()) << to_text(result);
}

TEST(SelfTest, WhatTheKernelDoesNotReportFailsNothing) {
  SelfTestResult result = good();
  result.idle.reset();
  result.throttled.reset();
  EXPECT_TRUE(result.passed());
  EXPECT_NE(to_text(result).find("not reported by the kernel"), std::string::npos);
}

TEST(SelfTest, InLockStepNothingIsSaidOfTheComputer) {
  SelfTestResult result = good();
  result.solve = {};
  EXPECT_TRUE(result.passed());
  for (const Check& check : result.checks()) {
    EXPECT_TRUE(check.name != "wake-up" && check.name != "planner" && check.name != "idle states");
  }
}

TEST(SelfTest, ATestThatCouldNotBeDoneHasNotPassed) {
  SelfTestResult result = good();
  result.failure = "the driver of knee_R is silent";
  EXPECT_FALSE(result.passed());
  EXPECT_EQ(to_text(result), "the driver of knee_R is silent\n");
  const auto json = nlohmann::json::parse(to_json(result));
  EXPECT_EQ(json.at("error"), "the driver of knee_R is silent");
  EXPECT_EQ(json.at("failure"), json.at("error")) << "its older name";
  EXPECT_FALSE(nlohmann::json::parse(to_json(good())).contains("error"));
  EXPECT_FALSE(SelfTestResult{}.passed());
}

}  // namespace
}  // namespace stilt::program
