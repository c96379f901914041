#include "firmware/torso_sensor/serial_torso_sensor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "tests/own_folder.h"
#include "tests/pseudo_terminal.h"

namespace stilt::torso_sensor {
namespace {

using hal::vectornav::Mounting;

/// Waits for something that must come, however slow the machine. False: a minute was not enough.
bool eventually(const std::function<bool()>& holds) {
  for (int i = 0; i < 60'000; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

void send(const tests::PseudoTerminal& terminal, double pitch_rad, double rate_rad_s) {
  terminal.write(hal::vectornav::encode(packet_of({pitch_rad, rate_rad_s}, Mounting{})));
}

TEST(SerialTorsoSensor, AMessageOnThePortIsASampleOfTheFeed) {
  const tests::PseudoTerminal terminal;
  SerialTorsoSensor sensor;
  ASSERT_TRUE(sensor.start({.port = terminal.port()}));
  EXPECT_EQ(sensor.newest().number, 0u);
  send(terminal, 0.25, -1.5);
  ASSERT_TRUE(eventually([&] { return sensor.newest().number == 1; }));
  const hal::TorsoSample& sample = sensor.newest();
  EXPECT_NEAR(sample.pitch_rad, 0.25, 1e-6);
  EXPECT_EQ(sample.pitch_rate_rad_s, -1.5);
  EXPECT_GT(sample.time_ns, 0);
  EXPECT_EQ(sample.malformed, 0u);
}

TEST(SerialTorsoSensor, AWrongChecksumIsCountedAndLosesOneMessage) {
  const tests::PseudoTerminal terminal;
  SerialTorsoSensor sensor;
  ASSERT_TRUE(sensor.start({.port = terminal.port()}));
  auto wrong = hal::vectornav::encode(packet_of({0.1, 0}, Mounting{}));
  wrong[10] ^= 1;
  terminal.write(wrong);
  send(terminal, 0.2, 0);
  ASSERT_TRUE(eventually([&] { return sensor.newest().number == 1; }));
  EXPECT_NEAR(sensor.newest().pitch_rad, 0.2, 1e-6);
  EXPECT_EQ(sensor.newest().malformed, 1u);
}

TEST(SerialTorsoSensor, ASilentPortAndOneWithoutMessagesAreNamed) {
  const tests::PseudoTerminal terminal;
  SerialTorsoSensor sensor;
  ASSERT_TRUE(sensor.start({.port = terminal.port()}));
  EXPECT_TRUE(eventually([&] { return sensor.trouble() == SerialTrouble::silent; }));
  const std::uint8_t text[] = "$VNYPR,+006.271,+000.031,-002.000*66\r\n";
  EXPECT_TRUE(eventually([&] {
    terminal.write(text);
    return sensor.trouble() == SerialTrouble::no_packet;
  }));
  EXPECT_TRUE(eventually([&] {
    send(terminal, 0, 0);
    return sensor.trouble() == SerialTrouble::none;
  }));
}

/// UM001, example case 1: yaw, pitch and roll alone.
TEST(SerialTorsoSensor, MessagesWithoutRatesAreNamed) {
  const tests::PseudoTerminal terminal;
  SerialTorsoSensor sensor;
  ASSERT_TRUE(sensor.start({.port = terminal.port()}));
  const std::uint8_t example[] = {0xfa, 0x01, 0x08, 0x00, 0x93, 0x50, 0x2e, 0x42, 0x83,
                                  0x3e, 0xf1, 0x3f, 0x48, 0xb5, 0x04, 0xbb, 0x92, 0x88};
  EXPECT_TRUE(eventually([&] {
    terminal.write(example);
    return sensor.trouble() == SerialTrouble::no_rate;
  }));
  EXPECT_TRUE(std::isnan(sensor.newest().pitch_rate_rad_s));
  EXPECT_NEAR(sensor.newest().pitch_rad, -0.0328946, 1e-6) << "1.8847202 degrees, nose up";
}

/// A sensor whose port has a name of its own, as in /dev/serial/by-id.
class NamedPort : public testing::Test {
 protected:
  void plug_in(const tests::PseudoTerminal& terminal) {
    std::filesystem::create_symlink(terminal.port(), link_);
  }
  void unplug(tests::PseudoTerminal& terminal) {
    std::filesystem::remove(link_);
    terminal.hang_up();
  }

  tests::OwnFolder folder_;
  std::string link_ = folder_.file("imu");
};

TEST_F(NamedPort, ThatIsPluggedInAgainIsReadAgain) {
  tests::PseudoTerminal first;
  plug_in(first);
  SerialTorsoSensor sensor;
  ASSERT_TRUE(sensor.start({.port = link_}));
  send(first, 0.1, 0);
  ASSERT_TRUE(eventually([&] { return sensor.newest().number == 1; }));
  unplug(first);
  EXPECT_TRUE(eventually([&] { return sensor.trouble() == SerialTrouble::gone; }));
  const tests::PseudoTerminal second;
  plug_in(second);
  EXPECT_TRUE(eventually([&] {
    send(second, 0.2, 0);
    return std::abs(sensor.newest().pitch_rad - 0.2) < 1e-6;
  }));
}

/// As a sensor that comes back without rights for stiltd, or is held by another program.
TEST_F(NamedPort, ThatIsThereAgainAndCannotBeOpenedSaysWhy) {
  tests::PseudoTerminal first;
  plug_in(first);
  SerialTorsoSensor sensor;
  ASSERT_TRUE(sensor.start({.port = link_}));
  unplug(first);
  const auto says = [&sensor](const std::string& text) {
    return eventually([&] { return sensor.trouble_sentence() == text; });
  };
  const std::string gone = sentence(SerialTrouble::gone, {.port = link_});
  EXPECT_TRUE(says(gone)) << sensor.trouble_sentence();
  std::ofstream(link_) << "no port";
  EXPECT_TRUE(says("torso sensor: serial port " + link_ +
                   ": cannot be set up (Inappropriate ioctl for device); is it a serial port?"))
      << sensor.trouble_sentence();
  std::filesystem::remove(link_);
  EXPECT_TRUE(says(gone)) << sensor.trouble_sentence();
  const tests::PseudoTerminal second;
  plug_in(second);
  EXPECT_TRUE(eventually([&] {
    send(second, 0.2, 0);
    return sensor.trouble_sentence().empty();
  })) << sensor.trouble_sentence();
}

TEST(SerialTorsoSensor, APortThatIsNotThereIsOneSentence) {
  SerialTorsoSensor sensor;
  const auto started = sensor.start({.port = "/nowhere/imu"});
  ASSERT_FALSE(started);
  EXPECT_TRUE(started.error().starts_with("serial port /nowhere/imu: cannot be opened"));
}

TEST(SerialTorsoSensor, EveryTroubleHasASentenceThatNamesThePort) {
  for (const SerialTrouble trouble :
       {SerialTrouble::gone, SerialTrouble::silent, SerialTrouble::no_packet, SerialTrouble::no_rate}) {
    EXPECT_NE(sentence(trouble, {.port = "/dev/imu"}).find("/dev/imu"), std::string::npos);
  }
  EXPECT_EQ(sentence(SerialTrouble::none, {}), "");
}

}  // namespace
}  // namespace stilt::torso_sensor
