#include <gtest/gtest.h>

#include "firmware/commissioning/jog_dialog.h"
#include "tests/firmware/commissioning/hanging_robot.h"

/// Drivers that lose their power at a question, and have it again before the answer.
namespace stilt::commissioning {
namespace {

using testing::HangingRobot;

constexpr std::size_t kJoint = 0;
constexpr double kAStepOfAFrame_Nm = 0.06;

/// Presses the emergency stop and releases it again before the first answer.
class Presser final : public Person {
 public:
  explicit Presser(HangingRobot& robot) : robot_(robot) {}
  void ask(const std::string& /*question*/) override {
    ++questions;
    asked_ns_ = robot_.now_ns();
    power(false);
  }
  std::optional<std::string> answer() override {
    if (robot_.now_ns() - asked_ns_ < 1'000'000'000) return std::nullopt;
    if (!powered_) power(true);
    if (robot_.now_ns() - asked_ns_ < 1'500'000'000) return std::nullopt;
    return "none";
  }
  bool gone() const override { return false; }
  bool patient() const override { return false; }

  int questions = 0;

 private:
  void power(bool on) {
    powered_ = on;
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      hal::EmulatedDriver& driver = robot_.robot.drivers().driver(joint);
      driver.set_powered(on);
      if (on) driver.power_cycle();
    }
  }

  HangingRobot& robot_;
  std::int64_t asked_ns_ = 0;
  bool powered_ = true;
};

TEST(LostPower, DriversThatLostItAtAQuestionAreNotTakenForADeadJoint) {
  HangingRobot robot({.both = {}, .robot = {}, .miswired = {"blocked:hip_L"}});
  Session session = robot.session();
  Presser person(robot);
  const JogRequest request = robot.jog_request(kJoint, 0.3);
  const auto report = jog_and_ask(session, request, {}, person);
  ASSERT_FALSE(report) << report->verdict.sentence;
  EXPECT_EQ(report.error().sentence, "driver of hip_L was disabled or has restarted: begin anew");
  EXPECT_EQ(person.questions, 1);
  EXPECT_LE(robot.peak_torque_Nm(kJoint), request.push_Nm + kAStepOfAFrame_Nm);
}

}  // namespace
}  // namespace stilt::commissioning
