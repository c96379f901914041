#include "firmware/commissioning/zero.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "hal/moteus/moteus_emulator.h"
#include "tests/firmware/commissioning/hanging_robot.h"

namespace stilt::commissioning {
namespace {

using testing::HangingRobot;
using Settings = std::vector<std::string>;

/// Both drivers of a leg, their shafts 0.3 rad away from their joints.
Settings drivers(const std::string& protocol) {
  if (protocol == "ak_v3") return testing::kAkV3;
  return {"hip_driver.protocol=" + protocol, "knee_driver.protocol=" + protocol};
}
const Settings kAway = {"hip_L.offset_rad=0.3"};

/// A bus on which a sensor sends beside the drivers, after everything else. Its frames have the first byte
/// and the length of a reply in MIT mode.
class BusWithASensor final : public hal::FrameBus {
 public:
  explicit BusWithASensor(hal::FrameBus& bus) : bus_(bus) {}

  [[nodiscard]] hal::SendResult send(std::span<const hal::CanFrame> frames) noexcept override {
    return bus_.send(frames);
  }
  [[nodiscard]] hal::ReceiveResult receive(std::span<hal::CanFrame> frames) noexcept override {
    hal::ReceiveResult result = bus_.receive(frames);
    constexpr std::array<std::uint8_t, 2> kLengths{6, 8};
    for (const std::uint8_t length : kLengths) {
      if (result.status != hal::BusStatus::ok || result.received == frames.size()) break;
      frames[result.received++] = {.id = 0x150, .length = length, .data = {1, 0xe0, 0, 0x80, 0, 0x80, 30, 0}};
    }
    return result;
  }
  [[nodiscard]] hal::BusHealth health() const noexcept override { return bus_.health(); }
  void clear_bus_off() noexcept override { bus_.clear_bus_off(); }
  [[nodiscard]] const hal::BusCounters& counters() const noexcept override { return bus_.counters(); }

 private:
  hal::FrameBus& bus_;
};

std::expected<ZeroReport, CommandFailure> zeroed(HangingRobot& robot, std::size_t joint = 0) {
  return set_zero(robot.configuration.hardware, joint, *robot.frame_buses()[joint / 2], robot, robot.stop);
}

class Zero : public ::testing::TestWithParam<const char*> {};

TEST_P(Zero, IsWhereTheJointIsHeldAndNoMotorIsOn) {
  HangingRobot robot({.both = drivers(GetParam()), .robot = kAway, .miswired = {}});
  const auto report = zeroed(robot);
  ASSERT_TRUE(report) << report.error().sentence;
  EXPECT_NEAR(report->before_rad, robot.robot.plant().state()[model::kFirstJoint] - 0.3, 0.05);
  EXPECT_TRUE(report->good()) << to_text(*report);
  EXPECT_FALSE(report->lasts.empty());
  EXPECT_FALSE(robot.robot.drivers().driver(0).enabled());
  const double limp_Nm = std::string(GetParam()) == "ak_v3" ? 0.03 : 0.0;  // half a step of a frame
  EXPECT_LE(robot.peak_torque_Nm(0), limp_Nm);
  EXPECT_EQ(nlohmann::json::parse(to_json(*report)).at("good"), true);
}

TEST_P(Zero, OfOneJointChangesNoOther) {
  HangingRobot robot({.both = drivers(GetParam()),
                      .robot = {"hip_L.offset_rad=0.3", "knee_L.offset_rad=0.3"},
                      .miswired = {}});
  ASSERT_TRUE(zeroed(robot, 0));
  const auto knee = zeroed(robot, 1);
  ASSERT_TRUE(knee) << knee.error().sentence;
  EXPECT_NEAR(knee->before_rad, robot.robot.plant().state()[model::kFirstJoint + 1] - 0.3, 0.05);
}

TEST_P(Zero, AFrameOfASensorIsNoPositionOfADriver) {
  HangingRobot robot({.both = drivers(GetParam()), .robot = kAway, .miswired = {}});
  BusWithASensor bus(*robot.frame_buses()[0]);
  const auto report = set_zero(robot.configuration.hardware, 0, bus, robot, robot.stop);
  ASSERT_TRUE(report) << report.error().sentence;
  EXPECT_NEAR(report->before_rad, robot.robot.plant().state()[model::kFirstJoint] - 0.3, 0.05);
  EXPECT_TRUE(report->good()) << to_text(*report);
}

TEST_P(Zero, OfADriverThatIsSilentIsNotSet) {
  HangingRobot robot({.both = drivers(GetParam()), .robot = {"hip_L.id=9"}, .miswired = {}});
  const auto report = zeroed(robot);
  ASSERT_FALSE(report);
  const std::string protocol = GetParam();
  const bool maybe_silent = protocol == "mit_ak" || protocol == "mit_mini_cheetah";
  EXPECT_EQ(
      report.error().sentence,
      std::string("the driver of hip_L does not answer") +
          (maybe_silent ? "; where stiltd scan finds it, correct reply_id; where only stiltd watch does, its "
                          "firmware is silent while the motor is off: set the zero with the vendor's tool"
                        : ""));
  EXPECT_FALSE(report.error().bad_answer);
}

INSTANTIATE_TEST_SUITE_P(Drivers, Zero,
                         ::testing::Values("mit_damiao", "mit_ak", "mit_mini_cheetah", "moteus", "ak_v3"),
                         [](const auto& row) { return std::string(row.param); });

/// By its firmware.
TEST(ZeroOfAnAk, ThatAnswersWithItsOwnIdentifierIsSet) {
  Settings settings = drivers("mit_ak");
  settings.emplace_back("hip_L.reply_id=1");
  HangingRobot robot({.both = settings, .robot = kAway, .miswired = {}});
  const auto report = zeroed(robot);
  ASSERT_TRUE(report) << report.error().sentence;
  EXPECT_TRUE(report->good()) << to_text(*report);
}

/// The driver counts from it as from its output, until it loses its power.
TEST(ZeroOfAMoteus, MakesThePositionOfARotorThatOfTheJoint) {
  HangingRobot robot({.both = drivers("moteus"), .robot = {}, .miswired = {}, .angles_known = true});
  robot.reference_to_rotors();
  const auto is_up = [&robot] {
    Session session = robot.session();
    const bool up = session.bring_up().has_value();
    session.disable();
    return up;
  };
  EXPECT_FALSE(is_up()) << "any turn of the rotor";
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) ASSERT_TRUE(zeroed(robot, joint));
  EXPECT_TRUE(is_up());
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint)
    robot.robot.drivers().driver(joint).power_cycle();
  EXPECT_FALSE(is_up());
}

/// Times that a command was sent to the left hip.
long times(const HangingRobot& robot, std::string_view command) {
  const hal::RobotWiring wiring = configuration::robot_wiring(robot.configuration.hardware);
  const auto& driver = std::get<hal::moteus::MoteusDriver>(wiring.joints[0].driver);
  return std::ranges::count_if(robot.buses[0].sent, [&](const hal::CanFrame& frame) {
    const auto text = hal::moteus::decode_console_request(driver, frame);
    return text && text->view().substr(0, text->view().find('\n')) == command;
  });
}

TEST(ZeroOfAMoteus, ThatIsDeafWhileItWritesItsFlashIsWrittenOnce) {
  constexpr std::int64_t kMillisecond_ns = 1'000'000;
  for (const std::int64_t deaf_ms : {25, 60, 300}) {
    for (const bool answers_afterwards : {false, true}) {
      HangingRobot robot({.both = drivers("moteus"), .robot = kAway, .miswired = {}});
      static_cast<hal::moteus::MoteusEmulator&>(robot.robot.drivers().driver(0))
          .set_flash(deaf_ms * kMillisecond_ns, answers_afterwards);
      const auto report = zeroed(robot);
      ASSERT_TRUE(report) << report.error().sentence;
      EXPECT_TRUE(report->good()) << to_text(*report);
      EXPECT_EQ(times(robot, "conf write"), 1) << deaf_ms;
      EXPECT_EQ(times(robot, "d exact 0"), 1) << deaf_ms;
    }
  }
}

TEST(ZeroOfAMoteus, ThatNeverEndsWritingIsWrittenOnceAndGivenUpAfterOneSecond) {
  HangingRobot robot({.both = drivers("moteus"), .robot = kAway, .miswired = {}});
  static_cast<hal::moteus::MoteusEmulator&>(robot.robot.drivers().driver(0))
      .set_flash(1'000'000'000'000, false);
  const std::int64_t began_ns = robot.now_ns();
  const auto report = zeroed(robot);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().sentence, "the driver of hip_L does not answer");
  EXPECT_EQ(times(robot, "conf write"), 1);
  EXPECT_LE(robot.now_ns() - began_ns, 1'200'000'000);
}

TEST(ZeroOfAnAkV3, IsWrittenToItsFlashOnceAndOnlyAfterItIsLimp) {
  HangingRobot robot({.both = drivers("ak_v3"), .robot = kAway, .miswired = {}});
  ASSERT_TRUE(zeroed(robot));
  int limp = 0, origins = 0;
  for (const hal::CanFrame& frame : robot.buses[0].sent) {
    if (frame.id == 0x801) {
      EXPECT_EQ(frame.length, 8);
      if (origins == 0) ++limp;
      continue;
    }
    EXPECT_EQ(frame.id, 0x501u);
    EXPECT_EQ(frame.length, 1);
    EXPECT_EQ(frame.data[0], 1) << "permanent";
    ++origins;
  }
  EXPECT_GE(limp, 3);
  EXPECT_EQ(origins, 1);
}

TEST(ZeroOfAnOdrive, IsRefusedBeforeAnythingIsSent) {
  HangingRobot robot({.both = drivers("odrive"), .robot = {}, .miswired = {}});
  const auto report = zeroed(robot);
  ASSERT_FALSE(report);
  EXPECT_TRUE(report.error().bad_answer);
  EXPECT_NE(report.error().sentence.find("counts from power-up"), std::string::npos);
  EXPECT_TRUE(robot.buses[0].sent.empty());
}

TEST(ZeroOfADriver, ThatHasNotTakenItIsNotGood) {
  ZeroReport report;
  EXPECT_FALSE(report.good()) << "not read back";
  report.after_rad = 0.03;
  EXPECT_FALSE(report.good());
  EXPECT_NE(to_text(report).find("has not taken it"), std::string::npos);
}

}  // namespace
}  // namespace stilt::commissioning
