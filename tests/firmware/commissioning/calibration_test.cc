#include "firmware/commissioning/calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace stilt::commissioning {
namespace {

using configuration::HardwareParameters;
using configuration::TorsoDevice;
using configuration::TorsoSensorParameters;

constexpr double kPeriod_s = 0.001;

/// A torso that rocks for 30 s, and a sensor with these gains and this bias of its rate.
TorsoReadings rocking(double pitch_gain, double rate_gain, double bias_rad_s = 0) {
  constexpr double kOmega_rad_s = 4, kRocking_rad = 0.15;
  TorsoReadings readings;
  readings.period_s = kPeriod_s;
  for (int i = 0; i < 30'000; ++i) {
    const double time_s = kPeriod_s * i;
    const double torso_rad = kRocking_rad * std::sin(kOmega_rad_s * time_s);
    readings.torso_rad.push_back(torso_rad);
    readings.pitch_rad.push_back(pitch_gain * torso_rad);
    readings.pitch_rate_rad_s.push_back(
        rate_gain * kRocking_rad * kOmega_rad_s * std::cos(kOmega_rad_s * time_s) + bias_rad_s);
  }
  return readings;
}

TorsoCalibration calibration(const TorsoReadings& readings, const TorsoSensorParameters& sensor = {}) {
  return calibrate_torso(torso_motion(readings), sensor);
}

TEST(Calibration, TheBiasOfAGyroscopeIsNoWrongRate) {
  const TorsoCalibration torso = calibration(rocking(1, 1, 0.01));
  EXPECT_STREQ(name(torso.finding), "correct") << torso.sentence;
  EXPECT_NEAR(torso.motion.rate.gain, 1, 0.02);
}

TEST(Calibration, ARateOfHalfTheScaleIsWrongDespiteItsBias) {
  EXPECT_EQ(calibration(rocking(1, 0.5, 0.01)).finding, TorsoFinding::wrong_rate);
}

std::map<std::string, std::string> torso_values(const TorsoSensorParameters& sensor,
                                                const TorsoCalibration& torso) {
  HardwareParameters hardware;
  hardware.torso_sensor = sensor;
  std::map<std::string, std::string> values;
  for (const configuration::NewValue& value : new_values(hardware, {}, torso)) {
    if (value.section == "torso_sensor") values[value.key] = value.value;
  }
  return values;
}

TorsoCalibration reversed_by(double offset_rad) {
  TorsoCalibration torso;
  torso.finding = TorsoFinding::changed;
  torso.reversed = torso.rate_reversed = true;
  torso.offset_rad = offset_rad;
  return torso;
}

using Values = std::map<std::string, std::string>;

TEST(Calibration, AnImuGetsItsOwnSignAndOffset) {
  for (const TorsoDevice device : {TorsoDevice::xsens_can, TorsoDevice::vectornav}) {
    TorsoSensorParameters sensor;
    sensor.device = device;
    sensor.imu_reversed = true;
    sensor.imu_offset_rad = 0.25;
    EXPECT_EQ(torso_values(sensor, reversed_by(0.5)),
              (Values{{"imu_reversed", "false"}, {"imu_offset_rad", "0.25"}}));
  }
}

TEST(Calibration, TheOffsetOfAnImuStaysWithinATurn) {
  TorsoSensorParameters sensor;
  sensor.device = TorsoDevice::vectornav;
  sensor.imu_offset_rad = -3.0;
  const double offset_rad = std::stod(torso_values(sensor, reversed_by(0.5)).at("imu_offset_rad"));
  EXPECT_NEAR(offset_rad, 3.5 - 2 * M_PI, 1e-12);
}

TEST(Calibration, AnEncoderGetsItsOwnSignAndOffsetWhateverReadsIt) {
  TorsoSensorParameters on_bus, of_a_moteus;
  on_bus.device = TorsoDevice::canopen_encoder;
  of_a_moteus.encoder_joint = 1;
  for (TorsoSensorParameters sensor : {on_bus, of_a_moteus}) {
    sensor.encoder_offset_rad = 0.25;
    EXPECT_EQ(torso_values(sensor, reversed_by(0.5)),
              (Values{{"encoder_reversed", "true"}, {"encoder_offset_rad", "0.25"}}));
  }
}

TEST(Calibration, APitchWithoutARateIsReversedAlone) {
  TorsoSensorParameters sensor;
  sensor.pitch_rate = "none";
  const Values values = torso_values(sensor, reversed_by(0.5));
  EXPECT_EQ(values.size(), 1u);
  EXPECT_TRUE(values.contains("pitch"));
}

TEST(Calibration, ARateThatTurnsAgainstThePitchIsWrongWhereOneSettingReversesBoth) {
  const TorsoReadings readings = rocking(1, -1);
  EXPECT_EQ(calibration(readings).finding, TorsoFinding::changed) << "channels have a sign each";
  TorsoSensorParameters sensor;
  for (const TorsoDevice device :
       {TorsoDevice::canopen_encoder, TorsoDevice::xsens_can, TorsoDevice::vectornav}) {
    sensor.device = device;
    EXPECT_EQ(calibration(readings, sensor).finding, TorsoFinding::wrong_rate);
    EXPECT_EQ(calibration(rocking(-1, -1), sensor).finding, TorsoFinding::changed);
  }
}

TEST(Calibration, AWrongScaleNamesTheKeyOfItsDevice) {
  TorsoSensorParameters sensor;
  EXPECT_NE(calibration(rocking(2, 1), sensor).sentence.find("torso_sensor.pitch"), std::string::npos);
  sensor.device = TorsoDevice::canopen_encoder;
  EXPECT_NE(calibration(rocking(2, 1), sensor).sentence.find("encoder_ratio"), std::string::npos);
  sensor.device = TorsoDevice::vectornav;
  EXPECT_NE(calibration(rocking(2, 1), sensor).sentence.find("imu_axis"), std::string::npos);
}

}  // namespace
}  // namespace stilt::commissioning
