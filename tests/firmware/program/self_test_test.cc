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
  result.planner_s = 1.0;
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
      {"hip_L", [](SelfTestResult& r) { r.missed[0] = 10; }},
      {"knee_R", [](SelfTestResult& r) { r.limits.missed_damp = 3, r.missed[3] = 3; }},
      {"torso sensor", [](SelfTestResult& r) { r.base_missed = 10; }},
      {"torso sensor", [](SelfTestResult& r) { r.last.base.pitch_rad = NAN; }},
      {"emergency stop", [](SelfTestResult& r) { r.emergency_stop_pressed = true; }},
      {"emergency stop", [](SelfTestResult& r) { r.emergency_stop_silent = true; }},
      {"emergency stop", [](SelfTestResult& r) { r.last.emergency_stop = hal::EmergencyStopState::absent; }},
      {"heat and supply", [](SelfTestResult& r) { r.limit_trouble = "hip_R is at 95 C"; }},
      {"bus errors", [](SelfTestResult& r) { r.bus_errors = 5; }},
      {"bus errors", [](SelfTestResult& r) { r.bus_trouble = "bus 0 of hardware.buses is gone"; }},
      {"wake-up", [](SelfTestResult& r) { r.late_ticks = 2; }},
      {"planner", [](SelfTestResult& r) { r.limits.plan_period_s = 0.9e-3, r.planner_s = 0.09; }},
      {"planner", [](SelfTestResult& r) { r.solve = {}; }},
      {"planner", [](SelfTestResult& r) { r.solve = {}, r.planner_s = 0.001; }},
      {"planner", [](SelfTestResult& r) { r.planner_s = 1.13; }},
      {"planner", [](SelfTestResult& r) { r.failed_solves = 2; }},
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
    EXPECT_FALSE(nlohmann::json::parse(to_json(result)).at("good").get<bool>()) << name;
  }
}

TEST(SelfTest, ABusThatIsGoneIsNamedBeforeTheDriversThatItSilences) {
  SelfTestResult result = good();
  result.bus_trouble = "bus 0 of hardware.buses is gone: look at its adapter";
  result.answered[0] = result.in_time[0] = 100;
  EXPECT_EQ(failed(result), (std::vector<std::string>{"bus errors", "hip_L"}));
  EXPECT_TRUE(to_text(result).starts_with(
      "FAILED  bus errors      bus 0 of hardware.buses is gone: look at its adapter; 0 (limit: at most "))
      << to_text(result);
}

TEST(SelfTest, OneThatIsStoppedHasItsMeasurementsAndHasNotPassed) {
  SelfTestResult result = good();
  result.stopped = "stopped after 0.1 of 60 s";
  EXPECT_EQ(failed(result), std::vector<std::string>{});
  EXPECT_FALSE(result.passed());
  EXPECT_TRUE(to_text(result).ends_with("\nfailed: stopped after 0.1 of 60 s\n")) << to_text(result);
  EXPECT_NE(to_text(result).find("knee_L at 0.250 rad"), std::string::npos) << to_text(result);
  const auto json = nlohmann::json::parse(to_json(result));
  EXPECT_EQ(json.at("good"), false);
  EXPECT_EQ(json.at("error"), "stopped after 0.1 of 60 s");
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
  result.missed[1] = 9;
  result.base_missed = 9;
  result.planner_s = 1.12;
  result.failed_solves = 1;
  result.bus_errors = 4;
  result.late_ticks = 1;
  result.idle->exit_us = 500.0;
  EXPECT_TRUE(result.passed()) << to_text(result);
}

/// Ten in a row of 10,000 are a share that passes, and the supervisor damps.
TEST(SelfTest, RepliesThatAreMissedInARowFailWithTheLimitOfTheSupervisor) {
  SelfTestResult result = good();
  result.ticks = 10'000;
  result.commands.fill(10'000);
  result.answered = {10'000, 9'990, 10'000, 10'000};
  result.in_time = result.answered;
  EXPECT_TRUE(result.passed()) << to_text(result);
  result.missed[1] = 10;
  EXPECT_EQ(failed(result), std::vector<std::string>{"knee_L"});
  EXPECT_NE(
      to_text(result).find("at most 10 missed in a row (limit: 99.90 and 99.00 %, fewer than 10 in a row)"),
      std::string::npos)
      << to_text(result);
  result.base_missed = 12;
  EXPECT_NE(to_text(result).find(
                "at most 12 missed in a row, pitch 0.010 rad (limit: pitch and rate, fewer than 10 "
                "missed in a row)"),
            std::string::npos)
      << to_text(result);
  const nlohmann::json json = nlohmann::json::parse(to_json(result));
  EXPECT_EQ(json.at("missed_replies").at("knee_L"), 10);
  EXPECT_EQ(json.at("missed_replies").at("hip_R"), 0);
  EXPECT_EQ(json.at("base_missed_replies"), 12);
}

TEST(SelfTest, TheLongestRunOfMissedRepliesIsKeptAndNoneOfBeforeTheTest) {
  SelfTestResult result;
  hal::RobotReadings readings;
  const auto tick = [&](std::uint32_t knee, std::uint32_t base) {
    ++result.ticks;
    readings.joints[1].missed_replies = knee;
    readings.base.missed_replies = base;
    result.keep_most_missed(readings);
  };
  tick(40, 50);
  tick(41, 51);
  EXPECT_EQ(result.missed[1], 2u);
  EXPECT_EQ(result.base_missed, 2u);
  for (std::uint32_t missed = 0; missed < 8; ++missed) tick(missed, 0);
  for (std::uint32_t missed = 0; missed < 5; ++missed) tick(missed, missed);
  EXPECT_EQ(result.missed, (std::array<std::uint32_t, hal::kJoints>{0, 7, 0, 0}));
  EXPECT_EQ(result.base_missed, 4u);
}

/// A planner that never ran has no solve that is late.
TEST(SelfTest, APlannerThatDidNotRunFailsAndTheComputerIsJudged) {
  SelfTestResult result = good();
  result.solve = {};
  result.late_ticks = 2;
  EXPECT_EQ(failed(result), (std::vector<std::string>{"wake-up", "planner"}));
  EXPECT_EQ(result.checks().size(), good().checks().size());
  const nlohmann::json json = nlohmann::json::parse(to_json(result));
  EXPECT_EQ(json.at("solves"), 0);
  EXPECT_EQ(json.at("lockstep"), false);
}

TEST(SelfTest, SolvesAreCountedAndTheirLimitsPrinted) {
  SelfTestResult result = good();
  result.failed_solves = 30;
  EXPECT_NE(to_text(result).find(
                "100 solves, 30 without a plan (limit: p99 within 10000 us, at least 90 solves, at "
                "most 1 % without a plan)"),
            std::string::npos)
      << to_text(result);
  EXPECT_EQ(nlohmann::json::parse(to_json(result)).at("solves"), 100);
  EXPECT_EQ(nlohmann::json::parse(to_json(result)).at("failed_solves"), 30);
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
  result.lockstep = true;
  EXPECT_TRUE(result.passed());
  EXPECT_EQ(nlohmann::json::parse(to_json(result)).at("lockstep"), true);
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
