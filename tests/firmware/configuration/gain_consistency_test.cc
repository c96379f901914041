#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "firmware/configuration/configuration.h"
#include "tests/firmware/configuration/with_drivers.h"

// Gains of the supervisor against what the drivers give.
namespace stilt::configuration {
namespace {

/// All diagnostics of a file, "" when it is accepted.
std::string mistakes(std::string_view toml) {
  const Result result = parse(toml, "robot.toml");
  return result ? "" : to_string(result.error());
}

TEST(Hardware, GainsThatADriverCannotGiveAreRefused) {
  const auto refuses = [](const std::string& toml, std::string_view gain, std::string_view limit) {
    const std::string found = mistakes(toml);
    return found.find(gain) != std::string::npos && found.find(limit) != std::string::npos;
  };
  EXPECT_EQ(mistakes("[knee_driver]\nratio = 0.5\n[supervisor]\nhold_kd_Nms_rad = 1\n"
                     "damping_kd_Nms_rad = 1\nhold_kp_Nm_rad = 200\n"),
            "robot.toml:6:18: supervisor.hold_kp_Nm_rad = 200 asks 800 Nm/rad of the shaft of a knee_driver, "
            "which gives at most knee_driver.kp_range_Nm_rad = 500; set supervisor.hold_kp_Nm_rad to at most "
            "125");
  EXPECT_PRED3(refuses, "[supervisor]\nhold_kd_Nms_rad = 6\n", "hold_kd", "hip_driver.kd_range_Nms_rad = 5");
  EXPECT_PRED3(refuses, "[supervisor]\ndamping_kd_Nms_rad = 6\n", "damping_kd", "knee_driver.kd_range");
  // 100 Nm/rad are 628 Nm per revolution, 4.5 Nm s/rad are 28.3.
  EXPECT_EQ(mistakes(with_drivers("moteus", "moteus_kp_Nm_rev = 629\nmoteus_kd_Nms_rev = 28.3\n")), "");
  EXPECT_PRED3(refuses, with_drivers("moteus", "moteus_kp_Nm_rev = 628\n"), "hold_kp",
               "moteus_kp_Nm_rev = 628");
  EXPECT_PRED3(refuses, with_drivers("moteus", "moteus_kd_Nms_rev = 28.2\n"), "damping_kd",
               "moteus_kd_Nms_rev");
  // The shaft of a geared driver needs less: 1 / ratio^2.
  EXPECT_EQ(
      mistakes(with_drivers("moteus", "ratio = 10\nmoteus_kp_Nm_rev = 6.3\nmoteus_kd_Nms_rev = 0.32\n")), "");
  // An ODrive is sent torques: its gains are computed here.
  EXPECT_EQ(mistakes(with_drivers("odrive", "", "[supervisor]\nhold_kp_Nm_rad = 2000\n")), "");
}

/// That of a Damiao or AK is the same in every firmware, and a larger range would scale every gain wrongly.
TEST(Hardware, ARangeIsOnlyRaisedWhereItIsTheUsersChoice) {
  const auto remedy = [](const char* protocol, const std::string& lines) {
    const std::string found =
        mistakes(with_drivers(protocol, lines, "[supervisor]\ndamping_kd_Nms_rad = 900\n"));
    const std::size_t at = found.find("; set ");
    return at == std::string::npos ? found : found.substr(at, found.find(" to at most", at) - at);
  };
  const std::string gain = "supervisor.damping_kd_Nms_rad";
  for (const char* protocol : {"mit_damiao", "mit_ak"}) EXPECT_EQ(remedy(protocol, ""), "; set " + gain);
  EXPECT_EQ(remedy("ak_v3", "position_range_rad = 12.56\n"), "; set " + gain);
  EXPECT_EQ(remedy("mit_mini_cheetah", ""), "; set that to the range of the driver's firmware, or " + gain);
  EXPECT_EQ(remedy("moteus", ""), "; set that to what the driver's own configuration allows, or " + gain);
}

/// The driver of a motor that gives less is asked for more. As shipped 4.5 of 5 Nm s/rad are in use.
TEST(Hardware, GainsOfAWeakMotorAreThoseAskedOfItsDriver) {
  EXPECT_EQ(mistakes("[hip_L]\ntorque_factor = 0.8\n\n[supervisor]\nhold_kd_Nms_rad = 4\n"),
            "robot.toml:2:17: supervisor.damping_kd_Nms_rad = 4.5 asks 5.625 Nm s/rad of the shaft of hip_L "
            "(hip_L.torque_factor = 0.8), whose driver gives at most hip_driver.kd_range_Nms_rad = 5; set "
            "supervisor.damping_kd_Nms_rad to at most 4");
  const std::string weak = mistakes("[knee_R]\ntorque_factor = 0.85\n\n[knee_L]\ntorque_factor = 0.88\n");
  EXPECT_NE(weak.find("of the shaft of knee_R (knee_R.torque_factor = 0.85)"), std::string::npos) << weak;
  EXPECT_NE(weak.find("damping_kd_Nms_rad to at most 4.25"), std::string::npos) << weak;
  for (const char* factor : {"0.9", "0.95", "1.1", "2.0"}) {
    EXPECT_EQ(mistakes("[hip_R]\ntorque_factor = " + std::string(factor) + "\n"), "") << factor;
  }
  const std::string weaker = mistakes("[hip_R]\ntorque_factor = 0.899\n");
  EXPECT_NE(weaker.find("of the shaft of hip_R (hip_R.torque_factor = 0.899)"), std::string::npos) << weaker;
  EXPECT_EQ(mistakes("[hip_L]\ntorque_factor = 0.8\n\n[supervisor]\nhold_kd_Nms_rad = 4\n"
                     "damping_kd_Nms_rad = 4\n"),
            "");
  EXPECT_EQ(mistakes(with_drivers("odrive", "", "[hip_L]\ntorque_factor = 0.5\n")), "");
}

/// Behind a gear of 91 the damping of a joint is less than half a step of kd. It would arrive as 0, and every
/// fault would end in a free fall.
TEST(Hardware, GainsThatAreFewStepsOfTheirFieldAreRefused) {
  const std::string found = mistakes("[hip_driver]\nratio = 91.43\n");
  EXPECT_TRUE(found.starts_with(
      "robot.toml:2:9: supervisor.hold_kp_Nm_rad = 100 asks 0.0119 Nm/rad of the shaft of a hip_driver, "
      "which has steps of 0.122, and fewer than 20 come out coarse or as 0; set hip_driver.ratio = 91.43 to "
      "at most 6.399 (1 where the driver counts its output), or supervisor.hold_kp_Nm_rad to at least "
      "20413.785\n"))
      << found;
  EXPECT_NE(found.find("supervisor.hold_kd_Nms_rad = 4.5 asks 0.000538 Nm s/rad"), std::string::npos)
      << found;
  EXPECT_TRUE(found.ends_with(
      "robot.toml:2:9: supervisor.damping_kd_Nms_rad = 4.5 asks 0.000538 Nm s/rad of the shaft of a "
      "hip_driver, which has steps of 0.00122, and fewer than 20 come out coarse or as 0; set "
      "hip_driver.ratio = 91.43 to at most 13.574 (1 where the driver counts its output), or "
      "supervisor.damping_kd_Nms_rad to at least 204.138"))
      << found;
  EXPECT_EQ(mistakes(with_drivers("odrive", "ratio = 91.43\n")), "") << "it gets torques";
}

TEST(Hardware, TwentyStepsOfAGainAreEnough) {
  for (const char* protocol : {"mit_damiao", "mit_ak", "mit_mini_cheetah", "ak_v3"}) {
    const std::string range = std::string(protocol) == "ak_v3" ? "position_range_rad = 12.56\n" : "";
    // 100 Nm/rad / 6.399^2 are 20 steps of 500 / 4095.
    EXPECT_EQ(mistakes(with_drivers(protocol, range + "ratio = 6.39\n")), "") << protocol;
    EXPECT_NE(mistakes(with_drivers(protocol, range + "ratio = 6.41\n")), "") << protocol;
    // 4.5 Nm s/rad / 13.574^2 are 20 steps of 5 / 4095.
    const std::string stiff = "[supervisor]\nhold_kp_Nm_rad = 500\n";
    EXPECT_EQ(mistakes(with_drivers(protocol, range + "ratio = 13.57\n", stiff)), "") << protocol;
    EXPECT_NE(mistakes(with_drivers(protocol, range + "ratio = 13.58\n", stiff))
                  .find("supervisor.hold_kd_Nms_rad = 4.5 asks"),
              std::string::npos)
        << protocol;
  }
  const std::string soft = mistakes("[supervisor]\nhold_kp_Nm_rad = 1\n");
  EXPECT_NE(soft.find("come out coarse or as 0; set supervisor.hold_kp_Nm_rad to at least 2.443"),
            std::string::npos)
      << "no ratio below 1: " << soft;
  EXPECT_EQ(mistakes("[supervisor]\nhold_kp_Nm_rad = 0\n"), "") << "0 arrives as it is";
}

/// Its driver is asked for less.
TEST(Hardware, StepsAreThoseOfTheStrongerMotor) {
  const std::string ratio = "[hip_driver]\nratio = 6\n";
  EXPECT_EQ(mistakes(ratio + "[hip_L]\ntorque_factor = 0.8\n"), "");
  const std::string strong = mistakes(ratio + "[hip_R]\ntorque_factor = 1.5\n");
  EXPECT_TRUE(
      strong.starts_with("robot.toml:4:17: supervisor.hold_kp_Nm_rad = 100 asks 1.851 Nm/rad of the "
                         "shaft of hip_R (hip_R.torque_factor = 1.5), whose driver has steps of 0.122"))
      << strong;
}

/// The scale of a gain is an int16 of the driver's own.
TEST(Hardware, AMoteusBehindALargeGearNeedsSmallerGainsOfItsOwn) {
  const std::string found = mistakes(with_drivers("moteus", "ratio = 91.43\n"));
  EXPECT_NE(found.find("set hip_driver.moteus_kp_Nm_rev = 800, and the driver's own gain, to at most 123.1"),
            std::string::npos)
      << found;
  EXPECT_NE(found.find("set knee_driver.moteus_kd_Nms_rev = 40, and the driver's own gain, to at most 5.5"),
            std::string::npos)
      << found;
  EXPECT_EQ(
      mistakes(with_drivers("moteus", "ratio = 91.43\nmoteus_kp_Nm_rev = 0.1\nmoteus_kd_Nms_rev = 0.01\n")),
      "");
}

}  // namespace
}  // namespace stilt::configuration
