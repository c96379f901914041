#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "firmware/commissioning/scan.h"
#include "tests/firmware/commissioning/hanging_robot.h"

// Scans that do not get to all drivers.
namespace stilt::commissioning {
namespace {

using testing::DirectBus;
using testing::HangingRobot;

/// A bus that is gone or off from some time on.
class FailingBus final : public hal::FrameBus {
 public:
  FailingBus(HangingRobot& robot, std::size_t bus, std::int64_t fails_ns)
      : robot_(robot), bus_(robot.buses[bus]), fails_ns_(fails_ns) {}

  [[nodiscard]] hal::SendResult send(std::span<const hal::CanFrame> frames) noexcept override {
    if (fails()) return {0, gone ? hal::BusStatus::disconnected : hal::BusStatus::unconfirmed};
    return bus_.send(frames);
  }
  [[nodiscard]] hal::ReceiveResult receive(std::span<hal::CanFrame> frames) noexcept override {
    if (fails()) return {0, gone ? hal::BusStatus::disconnected : hal::BusStatus::ok};
    return bus_.receive(frames);
  }
  [[nodiscard]] hal::BusHealth health() const noexcept override {
    return fails() && !gone ? hal::BusHealth::off : hal::BusHealth::active;
  }
  void clear_bus_off() noexcept override {}
  [[nodiscard]] const hal::BusCounters& counters() const noexcept override { return bus_.counters(); }

  bool gone = false;

 private:
  [[nodiscard]] bool fails() const { return robot_.now_ns() >= fails_ns_; }

  HangingRobot& robot_;
  DirectBus& bus_;
  std::int64_t fails_ns_;
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// From the start, and once the drivers of the configuration have answered.
TEST(ScanBus, OneThatIsGoneOrOffIsNamedBeforeTheDriversThatItSilences) {
  for (const std::int64_t after_ns : {0LL, 265'000'000LL}) {
    for (const bool gone : {true, false}) {
      HangingRobot robot;
      FailingBus failing(robot, 0, robot.now_ns() + after_ns);
      failing.gone = gone;
      const std::vector<hal::FrameBus*> buses = {&failing, &robot.buses[1]};
      const ScanResult result = scan(robot.configuration.hardware, robot.wanted(), buses, robot, robot.stop);
      EXPECT_FALSE(result.complete());
      const std::string text = to_text(result);
      EXPECT_TRUE(text.starts_with(gone ? "can0\n  GONE: " : "can0\n  OFF, after too many errors: ")) << text;
      EXPECT_FALSE(has(text, "NOTHING ACKNOWLEDGES")) << text;
      EXPECT_TRUE(has(text, "can1\n  hip_R (mit_damiao 3): answers")) << text;
      const auto json = nlohmann::json::parse(to_json(result));
      EXPECT_EQ(json["buses"][0]["gone"], gone);
      EXPECT_EQ(json["buses"][0]["off"], !gone);
      EXPECT_EQ(json["buses"][1]["gone"], false);
    }
  }
}

/// While it listens, between two drivers of the configuration, and while others are asked.
TEST(ScanBus, AScanThatIsStoppedIsNotCompleteAndTakesNoDriverForMissing) {
  HangingRobot whole;
  const std::int64_t began_ns = whole.now_ns();
  const auto scanned = [](HangingRobot& robot) {
    return scan(robot.configuration.hardware, robot.wanted(), robot.frame_buses(), robot, robot.stop);
  };
  ASSERT_TRUE(scanned(whole).complete());
  const std::int64_t all_ns = whole.now_ns() - began_ns;
  for (const std::int64_t after_ns :
       {std::int64_t{50'000'000}, std::int64_t{225'000'000}, all_ns - 10'000'000}) {
    HangingRobot robot;
    const std::int64_t until_ns = robot.now_ns() + after_ns;
    robot.each_tick = [&robot, until_ns] {
      if (robot.now_ns() >= until_ns) robot.stop = true;
    };
    const ScanResult result = scanned(robot);
    EXPECT_FALSE(result.complete()) << after_ns;
    const std::string text = to_text(result);
    EXPECT_TRUE(text.ends_with("\nnot complete: stopped, and not everything was asked\n")) << text;
    EXPECT_FALSE(has(text, "MISSING, no answer")) << text;
    EXPECT_FALSE(has(text, "SETTING")) << text;
    EXPECT_FALSE(has(text, "drivers of several protocols")) << text;
    EXPECT_FALSE(result.buses[1].asked_others) << after_ns;
    const auto json = nlohmann::json::parse(to_json(result));
    EXPECT_EQ(json["good"], false);
    EXPECT_EQ(json["error"], "stopped");
  }
  EXPECT_FALSE(nlohmann::json::parse(to_json(scanned(whole))).contains("error"));
}

}  // namespace
}  // namespace stilt::commissioning
