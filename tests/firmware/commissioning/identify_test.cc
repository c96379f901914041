#include "firmware/commissioning/identify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "firmware/robots/robots.h"
#include "tests/firmware/commissioning/hanging_robot.h"

namespace stilt::commissioning {
namespace {

using Protocol = configuration::DriverProtocol;
using testing::HangingRobot;
using testing::Wiring;

const model::RobotModel& amber3m() { return (*robots::find("amber3m"))->model; }

IdentificationRequest request_of(const HangingRobot& robot, double torque_share = 0.3) {
  return {.robot = &amber3m(),
          .torque_share = torque_share,
          .kp_Nm_rad = robot.configuration.supervisor.hold_kp_Nm_rad,
          .supervisor = robot.configuration.supervisor,
          .hardware = robot.configuration.hardware};
}

std::expected<IdentificationReport, std::string> tried(HangingRobot& robot, double torque_share = 0.3) {
  Session session = robot.session();
  return identify(session, request_of(robot, torque_share));
}

/// A plant with other numbers, and noise on its sensors.
struct Drives {
  const char* name;
  double torque_factor;
  double armature_kg_m2;
  double damping_Nms_rad;
  double friction_Nm;
  double noise_rad;
  int seed;
};

Wiring wiring_of(const Drives& drives) {
  return {
      .both = {},
      .robot = {},
      .miswired = {},
      .plant = {"armature=" + std::to_string(drives.armature_kg_m2),
                "joint_damping=" + std::to_string(drives.damping_Nms_rad),
                "joint_friction_Nm=" + std::to_string(drives.friction_Nm),
                "encoder_noise_rad=" + std::to_string(drives.noise_rad), "encoder_velocity_noise_rad_s=0.02",
                "base_pitch_noise_rad=0.001", "base_pitch_rate_noise_rad_s=0.01"},
      .torque_factor = drives.torque_factor,
      .seed = drives.seed,
      .angles_known = true};
}

void expect_within(double share, const Estimate& estimate, double truth, double at_least) {
  EXPECT_NEAR(estimate.value, truth, std::max(share * truth, at_least));
}

/// Of 95 %, so that one of 20 may miss by little; and narrow enough to be of use.
void expect_interval_holds(const Estimate& estimate, double truth) {
  EXPECT_NEAR(estimate.value, truth, 1.5 * estimate.half_width);
  EXPECT_LT(estimate.half_width, 0.02 * truth);
}

class IdentifyDrives : public ::testing::TestWithParam<Drives> {};

TEST_P(IdentifyDrives, IsWithinTenPercentOrThreeTenthsOfANewtonMetreOfFriction) {
  const Drives& truth = GetParam();
  HangingRobot robot(wiring_of(truth));
  const auto report = tried(robot);
  ASSERT_TRUE(report) << report.error();
  constexpr double kShare = 0.1, kFriction_Nm = 0.3;
  // Measured: armatures within 1.7 %; dampings within 0.105, the hips', whose gantry gives way; 0.02 at knees
  constexpr double kArmatureShare = 0.025, kDamping_Nms_rad = 0.13;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    SCOPED_TRACE("joint " + std::to_string(joint) + ", seed " + std::to_string(truth.seed));
    const DriveNumbers& drive = report->drives[joint];
    expect_within(kShare, drive.torque_factor, truth.torque_factor, 0);
    expect_within(kArmatureShare, drive.armature_kg_m2, truth.armature_kg_m2, 0);
    expect_within(kShare, drive.coulomb_friction_Nm, truth.friction_Nm, kFriction_Nm);
    expect_within(kShare, drive.damping_Nms_rad, truth.damping_Nms_rad, kDamping_Nms_rad);
    EXPECT_LE(robot.peak_torque_Nm(joint), 0.3 * 80.0 * std::max(1.0, truth.torque_factor) + 0.1);
    const bool knee = joint % 2 == 1;  // the gantry, which the intervals leave out, hardly moves with it
    if (knee) expect_interval_holds(drive.torque_factor, truth.torque_factor);
    if (knee) expect_interval_holds(drive.armature_kg_m2, truth.armature_kg_m2);
  }
  if (::testing::Test::HasFailure()) std::fputs(to_text(*report).c_str(), stderr);
}

INSTANTIATE_TEST_SUITE_P(ThreePlants, IdentifyDrives,
                         ::testing::Values(Drives{"AsInTheUrdf", 1.0, 0.4263, 0.5, 1.0, 0.0002, 1},
                                           Drives{"WeakAndRough", 0.85, 0.6, 1.5, 3.0, 0.0005, 2},
                                           Drives{"StrongAndLight", 1.15, 0.25, 0.2, 0.4, 0.001, 3}),
                         [](const auto& row) { return std::string(row.param.name); });

/// Their readings are up to 2 ms old, in steps of 0.1 degrees or of a tenth of that.
TEST(Identify, AnAkOfVersionThreeIsMeasuredAsWell) {
  for (const char* fine : {"false", "true"}) {
    Wiring wiring = wiring_of({"", 0.85, 0.4263, 0.5, 1.0, 0.0, 1});
    wiring.both = testing::kAkV3;
    wiring.both.push_back(std::string("hip_driver.ak_v3_position_frames=") + fine);
    wiring.both.push_back(std::string("knee_driver.ak_v3_position_frames=") + fine);
    HangingRobot robot(wiring);
    const auto report = tried(robot);
    ASSERT_TRUE(report) << report.error();
    for (const DriveNumbers& drive : report->drives) {
      expect_within(0.1, drive.torque_factor, 0.85, 0);
      expect_within(0.1, drive.armature_kg_m2, 0.4263, 0);
      expect_within(0.1, drive.coulomb_friction_Nm, 1.0, 0.3);
    }
    if (::testing::Test::HasFailure()) std::fputs(to_text(*report).c_str(), stderr);
  }
}

TEST(Identify, WritesMeansOfBothLegsAndNamesAWrongTorqueConstant) {
  HangingRobot robot(wiring_of({"", 0.8, 0.4263, 0.5, 1.0, 0.0002, 1}));
  const auto report = tried(robot);
  ASSERT_TRUE(report) << report.error();
  ASSERT_EQ(report->findings.size(), 4u) << to_text(*report);
  EXPECT_TRUE(report->findings[0].starts_with("hip_L gives 0.")) << report->findings[0];
  EXPECT_NE(report->findings[0].find("either write torque_factor = 0."), std::string::npos);
  const auto shipped = configuration::with_values("", "robot.toml", report->values);
  const auto refused = configuration::parse(*shipped, "robot.toml");
  ASSERT_FALSE(refused) << "4.5 of 5 Nm s/rad are 5.6 of these drivers";
  EXPECT_NE(configuration::to_string(refused.error()).find("hip_L"), std::string::npos);
  const std::string lowered = "[supervisor]\nhold_kd_Nms_rad = 3.5\ndamping_kd_Nms_rad = 3.5\n";
  const auto text = configuration::with_values(lowered, "robot.toml", report->values);
  const auto result = configuration::parse(*text, "robot.toml");
  ASSERT_TRUE(result) << configuration::to_string(result.error());
  EXPECT_NEAR(result->robot.hip_coulomb_friction_Nm, 1.0, 0.3);
  EXPECT_NEAR(result->robot.knee_coulomb_friction_Nm, 1.0, 0.3);
  EXPECT_NEAR(result->robot.hip_damping_Nms_rad, 0.5, 0.25);
  EXPECT_NEAR(result->robot.armature_scale, 1.0, 0.1);
  for (const configuration::JointParameters& joint : result->hardware.joint) {
    EXPECT_NEAR(joint.torque_factor, 0.8, 0.08);
  }
  const auto json = nlohmann::json::parse(to_json(*report, ""));
  EXPECT_FALSE(json["good"]);
  EXPECT_NEAR(json["joints"]["knee_R"]["torque_factor"]["value"], 0.8, 0.08);
  EXPECT_TRUE(json["written"].is_null());
}

TEST(Identify, AfterItsTorqueFactorIsWrittenAJointIsRight) {
  HangingRobot robot({.both = {"hip_L.torque_factor=0.8", "knee_R.torque_factor=1.25",
                               "supervisor.hold_kd_Nms_rad=4", "supervisor.damping_kd_Nms_rad=4"},
                      .robot = {},
                      .miswired = {}});
  const auto report = tried(robot);
  ASSERT_TRUE(report) << report.error();
  EXPECT_TRUE(report->findings.empty()) << to_text(*report);
  for (const DriveNumbers& drive : report->drives) expect_within(0.1, drive.torque_factor, 1.0, 0);
}

/// What is made of these torque factors, found with such drivers and one that is active.
IdentificationReport judged(const hal::JointValues& found, Protocol protocol, double active) {
  configuration::HardwareParameters hardware;
  hardware.hip.protocol = hardware.knee.protocol = protocol;
  hardware.joint[1].torque_factor = active;
  IdentificationReport report;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    report.drives[joint].torque_factor = {found[joint], 0.01};
    report.drives[joint].samples = 1000;
  }
  judge({.robot = &amber3m(), .hardware = hardware}, report);
  return report;
}

std::string factor_of(const IdentificationReport& report, const std::string& joint) {
  for (const configuration::NewValue& value : report.values) {
    if (value.section == joint && value.key == "torque_factor") return value.value;
  }
  return "";
}

TEST(Identify, ATorqueFactorCountsBesideTheActiveOne) {
  const IdentificationReport report = judged({1.05, 0.8, 0.91, 1.0}, Protocol::mit_damiao, 0.9);
  EXPECT_EQ(factor_of(report, "knee_L"), "0.72");
  for (const char* joint : {"hip_L", "hip_R", "knee_R"}) EXPECT_EQ(factor_of(report, joint), "") << joint;
  EXPECT_EQ(report.findings.size(), 1u) << to_text(report);
}

TEST(Identify, ATorqueFactorBeyondItsRangeIsNamedAndNotWritten) {
  const IdentificationReport report = judged({0.45, 0.8, 2.1, 1.0}, Protocol::mit_damiao, 0.6);
  ASSERT_EQ(report.findings.size(), 3u) << to_text(report);
  for (const std::string& finding : report.findings) {
    EXPECT_NE(finding.find("more than its torque_factor mends, 0.5 to 2"), std::string::npos) << finding;
  }
  EXPECT_EQ(report.values.size(), 5u) << "friction, damping and armature";
}

TEST(Identify, TheVendorsSettingIsNamedForEachProtocol) {
  const hal::JointValues found{0.8, 1, 1, 1};
  const auto finding = [&](Protocol protocol) { return judged(found, protocol, 1).findings.at(0); };
  EXPECT_EQ(finding(Protocol::moteus),
            "hip_L gives 0.80 Nm per Nm asked: either write torque_factor = 0.800, as --out does, or divide "
            "motor.Kv of its moteus by 0.800; then repeat");
  EXPECT_NE(
      finding(Protocol::odrive).find("multiply axis0.config.motor.torque_constant of its ODrive by 0.800"),
      std::string::npos);
  for (const Protocol mit :
       {Protocol::mit_damiao, Protocol::mit_ak, Protocol::mit_mini_cheetah, Protocol::ak_v3}) {
    EXPECT_NE(finding(mit).find("multiply the torque constant in its driver by 0.800"), std::string::npos);
  }
}

/// Four drives alike, with what `change` makes of them, beside the numbers of `robot`.
template <class Change>
IdentificationReport judged_with(const Change& change, const model::RobotModel& robot = amber3m()) {
  IdentificationReport report;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    DriveNumbers& drive = report.drives[joint];
    drive.torque_factor = {1, 0.01};
    drive.armature_kg_m2 = {amber3m().constants.joint_parameters[joint], 0.002};
    drive.damping_Nms_rad = {1, 0.03};
    drive.coulomb_friction_Nm = {2, 0.01};
    drive.samples = 1000;
  }
  change(report.drives);
  judge({.robot = &robot, .hardware = {}}, report);
  return report;
}

TEST(Identify, LegsThatDifferAreNamedBesideTheMeanThatIsWritten) {
  const IdentificationReport friction = judged_with([](auto& drives) {
    drives[1].coulomb_friction_Nm.value = 0.5;
    drives[3].coulomb_friction_Nm.value = 3.5;
  });
  ASSERT_EQ(friction.findings.size(), 1u) << to_text(friction);
  EXPECT_EQ(friction.findings[0],
            "the friction of knee_L is 0.5 Nm and of knee_R 3.5 Nm, and the file has one for both, 2: look "
            "what differs between the legs, and repeat");
  EXPECT_EQ(friction.values.size(), 5u) << "the mean is written";
  const IdentificationReport damping =
      judged_with([](auto& drives) { drives[2].damping_Nms_rad.value = 1.5; });
  ASSERT_EQ(damping.findings.size(), 1u) << to_text(damping);
  EXPECT_TRUE(damping.findings[0].starts_with("the damping of hip_L is 1 Nm s/rad and of hip_R 1.5"));
  const IdentificationReport armature =
      judged_with([](auto& drives) { drives[0].armature_kg_m2.value *= 1.3; });
  ASSERT_EQ(armature.findings.size(), 2u) << to_text(armature);
  EXPECT_TRUE(armature.findings[0].starts_with("the armature of hip_L is ")) << armature.findings[0];
}

TEST(Identify, HipsAndKneesWhoseArmaturesAreWrongUnlikeAreNamed) {
  const IdentificationReport report = judged_with([](auto& drives) {
    for (const std::size_t hip : {0u, 2u}) drives[hip].armature_kg_m2.value *= 1.3;
  });
  ASSERT_EQ(report.findings.size(), 1u) << to_text(report);
  EXPECT_EQ(report.findings[0],
            "the armature of the hips is 1.3 times that of the URDF and of the knees 1 times, and "
            "robot.armature_scale is one for both: write rotor inertia or gear ratio of the joints into the "
            "URDF, and repeat");
}

TEST(Identify, LegsThatDifferWithinWhatIsMeasuredAreAlike) {
  const IdentificationReport report = judged_with([](auto& drives) {
    drives[0].coulomb_friction_Nm.value += 0.29;
    drives[1].damping_Nms_rad.value += 0.24;
    drives[2].armature_kg_m2.value *= 1.09;
    drives[3].coulomb_friction_Nm = {2.9, 0.7};
  });
  EXPECT_TRUE(report.findings.empty()) << to_text(report);
}

/// AMBER-3M, whose URDF has no rotor inertia at these joints.
model::RobotModel without_rotors(const std::vector<std::size_t>& joints) {
  model::RobotModel robot = amber3m();
  for (const std::size_t joint : joints) robot.constants.joint_parameters[joint] = 0;
  return robot;
}

bool writes_armature_scale(const IdentificationReport& report) {
  return std::ranges::count(report.values, "armature_scale", &configuration::NewValue::key) > 0;
}

TEST(Identify, ARotorInertiaThatTheUrdfDoesNotHaveIsNamedForEachJointAndNoScaleIsWritten) {
  const IdentificationReport all = judged_with([](auto&) {}, without_rotors({0, 1, 2, 3}));
  ASSERT_EQ(all.findings.size(), 4u) << to_text(all);
  EXPECT_EQ(
      all.findings[0],
      "the URDF has no rotor inertia of hip_L, whose armature is 0.426 kg m^2: write rotorInertia = 0.426 "
      "/ mechanicalReduction^2 into its transmission, and repeat; no armature_scale is written");
  EXPECT_TRUE(all.findings[3].starts_with("the URDF has no rotor inertia of knee_R, ")) << all.findings[3];
  EXPECT_FALSE(writes_armature_scale(all));
  EXPECT_EQ(all.values.size(), 4u) << "friction and damping";
}

/// Four armatures over those of two joints would double the knees'.
TEST(Identify, AnArmatureThatTheUrdfDoesNotHaveIsNotGivenToOtherJoints) {
  const IdentificationReport hips = judged_with([](auto&) {}, without_rotors({0, 2}));
  ASSERT_EQ(hips.findings.size(), 2u) << to_text(hips);
  EXPECT_TRUE(hips.findings[1].starts_with("the URDF has no rotor inertia of hip_R, ")) << hips.findings[1];
  EXPECT_FALSE(writes_armature_scale(hips));
}

TEST(Identify, AJointWithoutARotorInertiaInTruthAndUrdfIsGoodAndLeftOutOfTheScale) {
  const IdentificationReport report = judged_with(
      [](auto& drives) {
        for (const std::size_t hip : {0u, 2u}) drives[hip].armature_kg_m2 = {0.0019, 0.002};
      },
      without_rotors({0, 2}));
  EXPECT_TRUE(report.findings.empty()) << to_text(report);
  ASSERT_TRUE(writes_armature_scale(report));
  EXPECT_EQ(report.values.back().value, "1") << to_text(report);
}

TEST(Identify, AnEmergencyStopEndsItLimp) {
  HangingRobot robot({.both = {}, .robot = {"torso_sensor.emergency_stop_released=none"}, .miswired = {}});
  const auto report = tried(robot);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error(), "emergency stop is silent");
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) EXPECT_LT(robot.peak_torque_Nm(joint), 0.06);
}

/// An AK of version 3 goes on with the last torque meanwhile.
TEST(Identify, AStallEndsItLimp) {
  HangingRobot robot(
      {.both = testing::kAkV3, .robot = {}, .miswired = {}, .plant = {}, .angles_known = true});
  testing::stall_with_torque(robot, 100'000'000);
  Session session = robot.session({.stall_s = 0.01});
  const auto excitation = excite(session, request_of(robot));
  ASSERT_FALSE(excitation);
  EXPECT_TRUE(excitation.error().starts_with("the loop stood still for 0.101 s")) << excitation.error();
  static_cast<void>(robot.sleep_until(robot.now_ns() + 2'000'000));
  EXPECT_LT(robot.robot.plant().applied_torque_Nm().cwiseAbs().maxCoeff(), 0.06) << "a step of a frame";
}

TEST(Identify, DriversAreOffBeforeAnythingIsFitted) {
  HangingRobot robot;
  Session session = robot.session();
  const auto excitation = excite(session, request_of(robot));
  ASSERT_TRUE(excitation) << excitation.error();
  static_cast<void>(robot.sleep_until(robot.now_ns() + 2'000'000));
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_FALSE(robot.robot.drivers().driver(joint).enabled());
    EXPECT_GT(excitation->records[joint].torque_Nm.size(), 20'000u);
  }
  const IdentificationReport report =
      identified(request_of(robot), *excitation);  // has no session to keep alive
  EXPECT_EQ(report.values.size(), 5u) << to_text(report);
}

TEST(Identify, APitchThatIsFrozenEndsIt) {
  HangingRobot robot;
  robot.lost_id = 0x150;
  robot.lost_from_ns = robot.now_ns() + 5'000'000'000;
  const auto report = tried(robot);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error(), "the torso sensor is silent");
}

TEST(Identify, AJointThatIsHeldEndsIt) {
  HangingRobot robot({.both = {}, .robot = {}, .miswired = {"blocked:knee_L"}});
  const auto report = tried(robot);
  ASSERT_FALSE(report);
  EXPECT_TRUE(report.error().starts_with("knee_L does not follow")) << report.error();
  static_cast<void>(robot.sleep_until(robot.now_ns() + 2'000'000));
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_FALSE(robot.robot.drivers().driver(joint).enabled());
  }
}

TEST(Identify, KeepsTheTorqueLimit) {
  HangingRobot robot;
  static_cast<void>(tried(robot, 0.05));  // the joints may be too weak to follow
  constexpr double kAStepOfAFrame_Nm = 0.06;
  for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
    EXPECT_LE(robot.peak_torque_Nm(joint), 0.05 * 80.0 + kAStepOfAFrame_Nm);
  }
  EXPECT_GT(robot.peak_torque_Nm(0), 0.04 * 80.0);
}

TEST(Identify, AJointOutsideItsTravelEndsIt) {
  HangingRobot robot({.both = {}, .robot = {"knee_R.offset_rad=2"}, .miswired = {}});
  const auto report = tried(robot);
  ASSERT_FALSE(report);
  EXPECT_TRUE(report.error().starts_with("knee_R is at -")) << report.error();
}

}  // namespace
}  // namespace stilt::commissioning
