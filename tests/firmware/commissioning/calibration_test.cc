#include "firmware/commissioning/calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "firmware/configuration/configuration.h"

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

/// Where the encoder of a boom counts from is anywhere in its turns.
TEST(Calibration, TheOffsetOfAnEncoderIsOneThatTheConfigurationTakes) {
  struct Encoder {
    int turns;
    double ratio;
  };
  TorsoCalibration torso;
  torso.finding = TorsoFinding::changed;
  for (const Encoder& encoder : {Encoder{1, 1}, Encoder{4096, 1}, Encoder{4096, 3}, Encoder{65536, 0.01}}) {
    SCOPED_TRACE(encoder.turns);
    TorsoSensorParameters sensor;
    sensor.device = TorsoDevice::canopen_encoder;
    sensor.encoder_turns = encoder.turns;
    sensor.encoder_ratio = encoder.ratio;
    const double period_rad = 2 * M_PI * encoder.turns / encoder.ratio;
    sensor.encoder_offset_rad = 0.4 * period_rad;
    torso.offset_rad = 0.3 * period_rad;
    const std::string offset = torso_values(sensor, torso).at("encoder_offset_rad");
    EXPECT_NEAR(std::stod(offset), -0.3 * period_rad, 1e-12 * period_rad) << "where the pitch repeats";
    const auto parsed =
        configuration::parse("[torso_sensor]\nencoder_offset_rad = " + offset + "\n", "robot.toml");
    EXPECT_TRUE(parsed) << configuration::to_string(parsed.error());
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

/// The same torso, its pitch and its rate late.
TorsoReadings late(double pitch_s, double rate_s) {
  TorsoReadings readings = rocking(1, 1);
  const auto shift = [](std::vector<double>& values, double late_s) {
    const auto count = static_cast<std::ptrdiff_t>(std::lround(late_s / kPeriod_s));
    std::rotate(values.begin(), values.end() - count, values.end());
    std::fill_n(values.begin(), count, values[static_cast<std::size_t>(count)]);
  };
  shift(readings.pitch_rad, pitch_s);
  shift(readings.pitch_rate_rad_s, rate_s);
  return readings;
}

TEST(Calibration, TheHalfWindowOfARateFromThePitchIsNotTheSensors) {
  TorsoSensorParameters channel, encoder;
  channel.pitch_rate = "none";
  encoder.device = TorsoDevice::canopen_encoder;
  for (TorsoSensorParameters sensor : {channel, encoder}) {
    sensor.rate_window_s = 0.05;
    EXPECT_EQ(calibration(late(0, 0.025), sensor).finding, TorsoFinding::correct);
    EXPECT_EQ(calibration(late(0.015, 0.040), sensor).finding, TorsoFinding::correct);
    const TorsoCalibration torso = calibration(late(0.030, 0.055), sensor);
    EXPECT_EQ(torso.finding, TorsoFinding::late) << "the sensor itself";
    EXPECT_EQ(
        torso.sentence,
        "late torso sensor: pitch by 30 ms, rate by 54 ms, 25 of them by torso_sensor.rate_window_s; at "
        "most 20 more are usable: look at its filter, its rate and its cable");
  }
}

TEST(Calibration, ARateOfTheSensorHasNoHalfWindow) {
  TorsoSensorParameters channel, encoder;
  encoder.device = TorsoDevice::canopen_encoder;
  encoder.encoder_speed_rad_s = 0.001;
  for (TorsoSensorParameters sensor : {channel, encoder}) {
    sensor.rate_window_s = 0.05;
    const TorsoCalibration torso = calibration(late(0, 0.025), sensor);
    EXPECT_EQ(torso.finding, TorsoFinding::late);
    EXPECT_EQ(
        torso.sentence,
        "late torso sensor: pitch by 0 ms, rate by 24 ms; at most 20 are usable: look at its filter, its "
        "rate and its cable");
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
