#include "firmware/configuration/gaits/gait_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "firmware/configuration/gaits/shipped_gaits.h"

namespace stilt::gait_files {
namespace {

/// A gait as it may come from elsewhere: outputs alone.
const std::string kBare = R"(
format = 1
robot = "amber3m"
[outputs]
phase = "hip_position"
phase_start_m = -0.1
phase_end_m = 0.05
degree = 4
stance_hip_rad = [-0.4, -0.35, -0.3, -0.25, -0.2]
stance_knee_rad = [0.4, 0.3, 0.3, 0.3, 0.5]
swing_hip_rad = [-0.2, -0.3, -0.5, -0.5, -0.4]
swing_knee_rad = [0.5, 0.9, 0.9, 0.5, 0.4]
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string error_of(const std::string& toml) {
  const auto record = parse_gait(toml, "gait.toml");
  return record ? "no error" : record.error();
}

TEST(GaitFile, ReadsBackWhatWasWrittenBitForBit) {
  for (const ShippedGait& shipped : shipped_gaits()) {
    const auto record = parse_gait(shipped.text, shipped.path);
    ASSERT_TRUE(record) << record.error();
    const std::string text = to_toml(*record);
    EXPECT_TRUE(text == shipped.text) << shipped.path;
    const auto again = parse_gait(text, "again");
    ASSERT_TRUE(again) << again.error();
    const gait::HzdGait& a = record->gait;
    const gait::HzdGait& b = again->gait;
    EXPECT_EQ(std::memcmp(&a.motion, &b.motion, sizeof a.motion), 0);
    EXPECT_EQ(std::memcmp(a.outputs.angle_rad, b.outputs.angle_rad, sizeof a.outputs.angle_rad), 0);
    EXPECT_EQ(a.step_time_s, b.step_time_s);
  }
}

TEST(GaitFile, ReadsBackClaimsThatAreNotFinite) {
  auto record = parse_gait(shipped_gaits()[0].text, "shipped");
  ASSERT_TRUE(record) << record.error();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  record->claims->friction_ratio_max = record->claims->return_map_eigenvalues[0] = kInfinity;
  record->claims->clearance_m = -kInfinity;
  record->claims->defect_max = std::nan("");
  const auto again = parse_gait(to_toml(*record), "again");
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(again->claims->friction_ratio_max, kInfinity);
  EXPECT_EQ(again->claims->return_map_eigenvalues[0], kInfinity);
  EXPECT_EQ(again->claims->clearance_m, -kInfinity);
  EXPECT_TRUE(std::isnan(again->claims->defect_max));
}

TEST(GaitFile, MayHoldOutputsAloneAndTakesDefaultsForTheRest) {
  const auto record = parse_gait(kBare, "bare.toml");
  ASSERT_TRUE(record) << record.error();
  EXPECT_EQ(record->gait.motion.degree, 0);
  EXPECT_EQ(record->gait.step_time_s, 0.0);
  EXPECT_DOUBLE_EQ(record->gait.step_length_m, 0.15);
  EXPECT_EQ(record->gait.outputs.degree, 4);
  EXPECT_EQ(record->gait.outputs.angle_rad[3][4], 0.4);
  EXPECT_EQ(record->limits.torque_Nm, gait_files::GaitLimits{}.torque_Nm);
  EXPECT_FALSE(record->claims);
}

TEST(GaitFile, AGaitAgainstTimeHasTheStepTimeOfItsPhase) {
  std::string text = replaced(kBare, "\"hip_position\"", "\"time\"");
  text = replaced(text, "phase_start_m = -0.1", "phase_start_s = 0");
  text = replaced(text, "phase_end_m = 0.05", "phase_end_s = 0.35");
  const auto record = parse_gait(text, "bare.toml");
  ASSERT_TRUE(record) << record.error();
  EXPECT_EQ(record->gait.outputs.phase, gait::PhaseKind::time);
  EXPECT_EQ(record->gait.step_time_s, 0.35);
}

TEST(GaitFile, SaysWhatIsWrongWhereAndWhatWouldBeRight) {
  EXPECT_EQ(error_of(replaced(kBare, "format = 1", "format = 2")),
            "gait.toml: format must be a whole number from 1 to 1");
  EXPECT_EQ(error_of(replaced(kBare, "amber3m", "atlas")),
            "gait.toml: robot: there is no robot \"atlas\"; known robots are amber3m, amber3m_2020, rabbit; "
            "or give a "
            "file that ends in .urdf");
  EXPECT_EQ(error_of(replaced(kBare, "degree = 4", "degree = 8")),
            "gait.toml: outputs.degree must be a whole number from 4 to 7");
  EXPECT_EQ(error_of(replaced(kBare, "degree = 4", "degree = 5")),
            "gait.toml: outputs.stance_hip_rad must be a list of 6 numbers");
  EXPECT_EQ(error_of(replaced(kBare, "0.9, 0.9", "0.9, inf")),
            "gait.toml: outputs.swing_knee_rad must hold finite numbers alone");
  EXPECT_EQ(error_of(replaced(kBare, "phase_end_m = 0.05", "phase_end_m = -0.1")),
            "gait.toml: outputs.phase_end_m must differ from phase_start_m");
  EXPECT_EQ(error_of(replaced(kBare, "\"hip_position\"", "\"knee\"")),
            "gait.toml: outputs.phase must be \"time\" or \"hip_position\"");
  EXPECT_EQ(error_of(replaced(kBare, "[outputs]", "[output]")),
            "gait.toml: output is not known; docs/gaits.md lists the keys");
  EXPECT_EQ(error_of("format = 1\nrobot = \"amber3m\"\n"), "gait.toml: the table [outputs] is missing");
  EXPECT_EQ(error_of(kBare + "[limits]\ntorque_nm = 3\n"),
            "gait.toml: limits.torque_nm is not known; docs/gaits.md lists the keys");
  EXPECT_EQ(error_of(kBare + "[limits]\ntorque_Nm = inf\n"), "gait.toml: limits.torque_Nm must be a number");
  EXPECT_EQ(error_of(kBare + "[states]\ndegree = 2\n"), "gait.toml: the table [inputs] is missing");
  EXPECT_EQ(error_of(kBare + "[inputs]\n"), "gait.toml: the table [states] is missing");
  EXPECT_EQ(error_of("format = "), error_of("format = "));
  EXPECT_NE(error_of("format = ").find("gait.toml: line 1 is not TOML"), std::string::npos);
  EXPECT_EQ(
      load_gait("/nowhere/gait.toml").error(),
      "/nowhere/gait.toml: the gait file cannot be read (No such file or directory); name an existing file");
}

/// A key with a slip of the pen must not be taken for one that was left out.
TEST(GaitFile, AKeyThatIsNotKnownIsRefusedByNameInEveryTable) {
  const std::string whole = std::string(shipped_gaits()[0].text);
  ASSERT_EQ(error_of(whole), "no error");
  const std::pair<const char*, const char*> slips[] = {
      {"speed_m_s = ", "sped_m_s"},           {"step_time_s = ", "step_time"},
      {"degree = ", "outputs.order"},         {"stance_hip_rad = ", "outputs.torso_rad"},
      {"placement = ", "feedback.placment"},  {"kd_1_s = ", "feedback.kd"},
      {"z_m = ", "states.height_m"},          {"stance_force_x_N = ", "inputs.force"},
      {"clearance_m = ", "limits.clearance"}, {"defect_max = ", "claims.defect"}};
  for (const auto& [line, key] : slips) {
    const std::string name(key);
    const std::string other = name.substr(name.find('.') == std::string::npos ? 0 : name.find('.') + 1);
    // A line more: what is needed is there.
    const std::string text = replaced(whole, std::string("\n") + line, "\n" + other + " = 1.0\n" + line);
    EXPECT_EQ(error_of(text), "gait.toml: " + name + " is not known; docs/gaits.md lists the keys");
  }
}

TEST(GaitFile, TheEndsOfAPhaseAreThoseOfItsKind) {
  EXPECT_EQ(error_of(replaced(kBare, "phase_end_m", "phase_end_s = 0.3\nphase_end_m")),
            "gait.toml: outputs.phase_end_s is not known; docs/gaits.md lists the keys");
}

}  // namespace
}  // namespace stilt::gait_files
