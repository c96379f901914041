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

/// From the start, and while drivers are asked.
TEST(ScanBus, OneThatIsGoneOrOffIsNamedBeforeTheDriversThatItSilences) {
  for (const std::int64_t after_ns : {0LL, 250'000'000LL}) {
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

}  // namespace
}  // namespace stilt::commissioning
