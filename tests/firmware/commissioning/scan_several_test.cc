#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <nlohmann/json.hpp>

#include "firmware/commissioning/scan.h"
#include "hal/robot/emulated_joint.h"
#include "tests/firmware/commissioning/hanging_robot.h"

// Drivers with one identifier on a bus: all of them follow its commands.
namespace stilt::commissioning {
namespace {

using testing::DirectBus;
using testing::HangingRobot;
using Settings = std::vector<std::string>;

/// A bus with one driver more, whose answers follow or collide with those of the others.
class BusWithAnother final : public hal::FrameBus {
 public:
  BusWithAnother(HangingRobot& robot, std::size_t bus, const hal::JointEmulator& emulator)
      : robot_(robot), bus_(robot.buses[bus]), emulator_(emulator) {
    hal::visit_driver(emulator_, [](auto& any) { any.motor.position_rad = 0.25; });
  }

  [[nodiscard]] hal::SendResult send(std::span<const hal::CanFrame> frames) noexcept override {
    for (const hal::CanFrame& frame : frames) {
      with_emulator([&](auto& any, hal::FrameSink& sink) { any.take(robot_.now_ns(), frame, sink); });
    }
    return bus_.send(frames);
  }
  [[nodiscard]] hal::ReceiveResult receive(std::span<hal::CanFrame> frames) noexcept override {
    with_emulator([&](auto& any, hal::FrameSink& sink) { any.elapse(robot_.now_ns(), sink); });
    if (collide) std::erase_if(bus_.waiting, [this](const hal::CanFrame& frame) { return collides(frame); });
    for (const hal::CanFrame& frame : own_) {
      if (collide) ++counters_.error_frames;
      if (!collide) bus_.waiting.push_back(frame);
    }
    own_.clear();
    return bus_.receive(frames);
  }
  [[nodiscard]] hal::BusHealth health() const noexcept override {
    return collide && counters_.error_frames > 0 ? hal::BusHealth::passive : hal::BusHealth::active;
  }
  void clear_bus_off() noexcept override {}
  [[nodiscard]] const hal::BusCounters& counters() const noexcept override { return counters_; }

  bool collide = false;

 private:
  template <typename Call>
  void with_emulator(Call call) noexcept {
    hal::FrameSink sink;
    hal::visit_driver(emulator_, [&](auto& any) { call(any, sink); });
    own_.insert(own_.end(), sink.frames().begin(), sink.frames().end());
  }
  [[nodiscard]] bool collides(const hal::CanFrame& frame) const {
    return std::ranges::any_of(own_, [&frame](const hal::CanFrame& own) { return own.id == frame.id; });
  }

  HangingRobot& robot_;
  DirectBus& bus_;
  hal::JointEmulator emulator_;
  std::deque<hal::CanFrame> own_;
  hal::BusCounters counters_;
};

/// Hands every second frame over some milliseconds late. A frame more may come after the first question.
class LateBus final : public hal::FrameBus {
 public:
  LateBus(HangingRobot& robot, std::size_t bus, int late_ms)
      : robot_(robot), bus_(robot.buses[bus]), late_ms_(late_ms) {}

  [[nodiscard]] hal::SendResult send(std::span<const hal::CanFrame> frames) noexcept override {
    if (report) bus_.waiting.push_back(*report);
    report.reset();
    return bus_.send(frames);
  }
  [[nodiscard]] hal::ReceiveResult receive(std::span<hal::CanFrame> frames) noexcept override {
    for (const hal::CanFrame& frame : bus_.waiting) {
      const int late_ms = frame.id == 0x150 || ++count_ % 2 == 0 ? 0 : late_ms_;
      on_their_way_.emplace_back(robot_.now_ns() + late_ms * 1'000'000LL, frame);
    }
    bus_.waiting.clear();
    std::size_t received = 0;
    std::erase_if(on_their_way_, [&](const auto& one) {
      const bool arrives = one.first <= robot_.now_ns() && received < frames.size();
      if (arrives) frames[received++] = one.second;
      return arrives;
    });
    return {received, received == frames.size() ? hal::BusStatus::more : hal::BusStatus::ok};
  }
  [[nodiscard]] hal::BusHealth health() const noexcept override { return bus_.health(); }
  void clear_bus_off() noexcept override {}
  [[nodiscard]] const hal::BusCounters& counters() const noexcept override { return bus_.counters(); }

  std::optional<hal::CanFrame> report;

 private:
  HangingRobot& robot_;
  DirectBus& bus_;
  int late_ms_;
  int count_ = 0;
  std::deque<std::pair<std::int64_t, hal::CanFrame>> on_their_way_;
};

/// With another first bus than the robot's.
ScanResult scanned(HangingRobot& robot, hal::FrameBus& first) {
  const std::array<hal::FrameBus*, 2> buses{&first, &robot.buses[1]};
  return scan(robot.configuration.hardware, robot.wanted(), buses, robot, robot.stop);
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

class ScanSeveral : public ::testing::TestWithParam<const char*> {
 protected:
  static Settings settings() {
    if (std::string(GetParam()) == "ak_v3") return testing::kAkV3;
    return {std::string("hip_driver.protocol=") + GetParam(),
            std::string("knee_driver.protocol=") + GetParam(), "hip_driver.accept_missing_watchdog=true",
            "knee_driver.accept_missing_watchdog=true"};
  }
};

TEST_P(ScanSeveral, DriversOfOneIdentifierAreNamed) {
  HangingRobot robot({.both = settings(), .robot = {}, .miswired = {}});
  const hal::RobotWiring wiring = configuration::robot_wiring(robot.configuration.hardware);
  BusWithAnother bus(robot, 0, hal::make_emulator(wiring.joints[0].driver));
  const ScanResult result = scanned(robot, bus);
  EXPECT_FALSE(result.complete());
  EXPECT_TRUE(has(to_text(result), "ANSWERS, BUT NOT WELL, SEVERAL drivers answer with identifier 1 ("))
      << to_text(result);
  EXPECT_TRUE(result.buses[0].expected[1].good()) << to_text(result);
  const auto json = nlohmann::json::parse(to_json(result));
  EXPECT_EQ(json["buses"][0]["drivers"][0]["several_drivers"], true);
  EXPECT_EQ(json["buses"][0]["drivers"][1]["several_drivers"], false);
}

TEST_P(ScanSeveral, LateAnswersAreNotThoseOfAnotherDriver) {
  for (const int late_ms : {3, 8, 10, 12, 19}) {
    HangingRobot robot({.both = settings(), .robot = {}, .miswired = {}});
    LateBus bus(robot, 0, late_ms);
    const ScanResult result = scanned(robot, bus);
    for (const ScannedNode& node : result.buses[0].expected) {
      EXPECT_TRUE(node.several.empty()) << late_ms << " ms\n" << to_text(result);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Drivers, ScanSeveral,
                         ::testing::Values("mit_damiao", "mit_ak", "mit_mini_cheetah", "moteus", "odrive",
                                           "ak_v3"),
                         [](const auto& row) { return std::string(row.param); });

const Settings kOdrive = {"hip_driver.protocol=odrive", "knee_driver.protocol=odrive",
                          "hip_driver.accept_missing_watchdog=true",
                          "knee_driver.accept_missing_watchdog=true"};

/// It reports its angle 100 times per second: the rate of both is no evidence.
TEST(ScanSeveralOdrive, OneOfThemASpareOfTheFactory) {
  HangingRobot robot({.both = kOdrive, .robot = {}, .miswired = {}});
  const hal::RobotWiring wiring = configuration::robot_wiring(robot.configuration.hardware);
  const auto& odrive = std::get<hal::odrive::OdriveDriver>(wiring.joints[0].driver);
  BusWithAnother bus(robot, 0, hal::odrive::OdriveEmulator(odrive));
  const std::string text = to_text(scanned(robot, bus));
  EXPECT_TRUE(has(text, "SEVERAL drivers answer with identifier 1 (")) << text;
  EXPECT_TRUE(has(text, " questions)")) << text;
}

/// Of its temperatures, which it is asked for as well.
TEST(ScanSeveralOdrive, AReportOnceInASecondIsNotThatOfAnotherDriver) {
  HangingRobot robot({.both = kOdrive, .robot = {}, .miswired = {}});
  LateBus bus(robot, 0, 0);
  bus.report = hal::classic_frame(1u << 5 | 0x15, 8);
  const ScanResult result = scanned(robot, bus);
  EXPECT_TRUE(result.complete()) << to_text(result);
}

/// As it comes from the vendor, its replies have another identifier.
TEST(ScanSeveralDamiao, OneOfThemASpareOfTheFactory) {
  HangingRobot robot;
  hal::RobotWiring wiring = configuration::robot_wiring(robot.configuration.hardware);
  std::get<hal::mit::MitDriver>(wiring.joints[0].driver).reply_id = 0;
  BusWithAnother bus(robot, 0, hal::make_emulator(wiring.joints[0].driver));
  EXPECT_TRUE(has(to_text(scanned(robot, bus)), "SEVERAL drivers answer with identifier 1"));
}

TEST(ScanSeveralDamiao, WhoseAnswersCollideAreErrorsOfTheBus) {
  HangingRobot robot;
  const hal::RobotWiring wiring = configuration::robot_wiring(robot.configuration.hardware);
  BusWithAnother bus(robot, 0, hal::make_emulator(wiring.joints[0].driver));
  bus.collide = true;
  const ScanResult result = scanned(robot, bus);
  EXPECT_FALSE(result.complete());
  const std::string text = to_text(result);
  EXPECT_TRUE(has(text, "MISSING, no answer, 6 bus errors while it was asked")) << text;
  EXPECT_TRUE(has(text, "  BUS ERRORS: 6 while a driver was asked in vain: several of one identifier, or "))
      << text;
  EXPECT_FALSE(has(text, "NOTHING ACKNOWLEDGES")) << text;
  EXPECT_TRUE(result.buses[0].expected[1].good()) << text;
  EXPECT_EQ(nlohmann::json::parse(to_json(result))["buses"][0]["bus_errors"], 6);
}

/// Two spares, of whose answers nothing arrives.
TEST(ScanSeveralDamiao, ThatTheConfigurationDoesNotNameAreErrorsOfTheBus) {
  HangingRobot robot;
  hal::RobotWiring wiring = configuration::robot_wiring(robot.configuration.hardware);
  auto& damiao = std::get<hal::mit::MitDriver>(wiring.joints[0].driver);
  damiao.command_id = damiao.driver_id = 9;
  BusWithAnother bus(robot, 0, hal::make_emulator(wiring.joints[0].driver));
  bus.collide = true;
  const ScanResult result = scanned(robot, bus);
  EXPECT_TRUE(result.buses[0].unexpected.empty());
  EXPECT_TRUE(std::ranges::all_of(result.buses[0].expected, &ScannedNode::good)) << to_text(result);
  EXPECT_TRUE(has(to_text(result), "  BUS ERRORS: ")) << to_text(result);
  EXPECT_FALSE(result.complete());
}

/// Reports wait in the queue of a bus while others are scanned.
TEST(ScanSeveralAkV3, RatesOfTheSecondBusAreThoseOfTheTimeItWasListenedTo) {
  HangingRobot robot({.both = testing::kAkV3,
                      .robot = {"hip_driver.ak_v3_status_rate_hz=200", "hardware.longest_reply_lag_s=0.01"},
                      .miswired = {}});
  const ScanResult result = scanned(robot, robot.buses[0]);
  for (const ScannedBus& bus : result.buses) {
    EXPECT_NEAR(std::stod(bus.expected[0].settings[0].is), 200, 10);
    EXPECT_TRUE(bus.expected[0].several.empty()) << bus.expected[0].several;
  }
}

}  // namespace
}  // namespace stilt::commissioning
