#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "hal/serial/serial_port.h"
#include "hal/vectornav/vectornav.h"
#include "host_tools/simulation/robot_on_bus/serial_line.h"
#include "tests/host_tools/simulation/robot_on_bus/driven_robot.h"
#include "tests/own_folder.h"

// The simulated robot's torso sensors that are no channels.
namespace stilt::robot_on_bus {
namespace {

using testing_support::DrivenRobot;
using testing_support::RobotRequest;

double pitch_rad(const DrivenRobot& driven) { return driven.robot.plant().state()[model::kFirstAngle]; }
double pitch_rate_rad_s(const DrivenRobot& driven) {
  return driven.robot.plant().state()[model::kPositions + model::kFirstAngle];
}

struct Device {
  const char* name;
  std::vector<std::string> settings;
  double pitch_error_rad;
  double rate_error_rad_s;
};

class TorsoSensorDevice : public testing::TestWithParam<Device> {};

/// A push swings the hanging robot: what is read follows the plant's truth.
TEST_P(TorsoSensorDevice, ReadsTheTorsoOfThePlant) {
  RobotRequest request{.settings = {"torso_sensor.rate_hz=1000"}, .plant = {}, .faults = {}, .pushes = {}};
  request.settings.insert(request.settings.end(), GetParam().settings.begin(), GetParam().settings.end());
  DrivenRobot driven(request);
  for (int i = 0; i < 150; ++i) driven.tick();
  hal::JointCommands commands{};
  for (int i = 0; i < 500; ++i) {
    driven.tick(&commands);
    EXPECT_EQ(driven.base.missed_replies, 0u) << i;
    EXPECT_NEAR(driven.base.pitch_rad, pitch_rad(driven), GetParam().pitch_error_rad) << i;
    EXPECT_NEAR(driven.base.pitch_rate_rad_s, pitch_rate_rad_s(driven), GetParam().rate_error_rad_s) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    RobotOnBus, TorsoSensorDevice,
    testing::Values(Device{"CanopenEncoder",
                           {"torso_sensor.device=canopen_encoder", "torso_sensor.encoder_ratio=3",
                            "torso_sensor.encoder_turns=4096", "torso_sensor.encoder_reversed=true",
                            "torso_sensor.encoder_offset_rad=0.2"},
                           2e-3,
                           0.1},
                    Device{"CanopenEncoderWithSpeed",
                           {"torso_sensor.device=canopen_encoder", "torso_sensor.encoder_speed_rad_s=0.001"},
                           2e-3,
                           0.1},
                    Device{"Xsens",
                           {"torso_sensor.device=xsens_can", "torso_sensor.rate_hz=333",
                            "torso_sensor.imu_axis=roll", "torso_sensor.imu_reversed=true",
                            "torso_sensor.imu_offset_rad=-0.1"},
                           2e-4,
                           2e-3}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(RobotOnBus, AVectornavSendsThePitchOfThePlantAtItsRate) {
  const std::vector<std::string> settings{"torso_sensor.device=vectornav", "torso_sensor.rate_hz=250"};
  DrivenRobot driven({.settings = settings, .plant = {}, .faults = {}, .pushes = {}});
  hal::vectornav::Stream stream;
  int messages = 0;
  for (int i = 0; i < 400; ++i) {
    driven.tick();
    static_cast<void>(stream.push(driven.robot.take_serial()));
    hal::vectornav::Packet packet;
    while (stream.next(packet)) {
      ++messages;
      const hal::vectornav::Pitch pitch = pitch_of(packet, {});
      EXPECT_NEAR(pitch.angle_rad, pitch_rad(driven), 1e-6);
      EXPECT_NEAR(pitch.rate_rad_s, pitch_rate_rad_s(driven), 1e-6);
    }
  }
  EXPECT_EQ(messages, 100);
}

TEST(SerialLine, IsAPortOfThatNameUntilItEnds) {
  const tests::OwnFolder folder;
  const std::string path = folder.file("imu");
  {
    const SerialLine line(path);
    auto port = hal::serial::SerialPort::open(path, 921600);
    ASSERT_TRUE(port) << port.error();
    const std::uint8_t sent[] = {1, 13, 3, 255};
    line.write(sent);
    std::uint8_t received[8];
    ASSERT_TRUE(port->wait(20'000'000'000));
    EXPECT_EQ(port->read(received), 4);
    EXPECT_EQ(received[1], 13);
    for (int i = 0; i < 10000; ++i) line.write(sent);  // without a reader: returns
  }
  struct stat ignored{};
  EXPECT_NE(lstat(path.c_str(), &ignored), 0) << "the link is gone";
}

TEST(SerialLine, DoesNotReplaceAFile) {
  const tests::OwnFolder folder;
  std::ofstream(folder.file("imu")) << "mine";
  try {
    const SerialLine line(folder.file("imu"));
    ADD_FAILURE() << "replaced";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("exists; the simulated sensor makes a port of that name"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace stilt::robot_on_bus
