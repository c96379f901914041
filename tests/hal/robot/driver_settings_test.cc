#include "hal/robot/driver_settings.h"

#include <gtest/gtest.h>

#include <bit>

#include "hal/ak/ak_emulator.h"
#include "hal/mit/mit_emulator.h"
#include "hal/moteus/moteus_emulator.h"
#include "hal/odrive/odrive_emulator.h"

// All settings of a driver that are read back at once, as they come from the vendor.
namespace stilt::hal {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr int kListened = 200;  // ticks

/// What is wrong, each name followed by what it is.
std::string wrong(const std::vector<ReadSetting>& settings) {
  std::string names;
  for (const ReadSetting& setting : settings) {
    if (!setting.right) names += setting.name + " " + setting.is + "; ";
  }
  return names;
}

/// Listens, then asks until there is nothing more to ask. Every `lost`-th answer is lost.
std::vector<ReadSetting> read(const JointDriver& driver, EmulatedDriver& emulator,
                              const bring_up::Options& options = {}, int lost = 0) {
  SettingReader reader = make_setting_reader(driver, options);
  std::int64_t now_ns = 0;
  for (int tick = 0; tick < kListened; ++tick) {
    FrameSink sent;
    emulator.elapse(now_ns += kMillisecond_ns, sent);
    for (const CanFrame& frame : sent.frames()) {
      visit_driver(reader, [&](auto& any) { any.listen(frame); });
    }
  }
  int unanswered = 0, answers = 0;
  for (int frames = 0; frames < 10'000; ++frames) {
    const bool give_up = unanswered == 5;
    if (give_up) unanswered = 0;
    const auto question = visit_driver(reader, [&](auto& any) { return any.next(unanswered > 0, give_up); });
    if (!question) break;
    FrameSink replies;
    emulator.take(now_ns += kMillisecond_ns, *question, replies);
    bool answered = false;
    for (const CanFrame& frame : replies.frames()) {
      if (lost > 0 && ++answers % lost == 0) continue;
      answered = visit_driver(reader, [&](auto& any) { return any.take(frame); }) || answered;
    }
    unanswered = answered ? 0 : unanswered + 1;
  }
  return visit_driver(reader, [](const auto& any) { return any.settings(1e-3 * kListened); });
}

moteus::MoteusDriver moteus_driver() {
  moteus::MoteusDriver driver;
  driver.kp_Nm_rev = 800;
  driver.kd_Nm_s_rev = 40;
  return driver;
}

TEST(DriverSettings, OfAMoteusFromTheVendorAreAllNamedAtOnce) {
  const moteus::MoteusDriver driver = moteus_driver();
  moteus::MoteusEmulator factory(driver, {});
  const std::string all =
      "servo.pid_position.kp 4.000000; servo.pid_position.ki 1.000000; servo.pid_position.kd 0.050000; "
      "servopos.position_min -0.010000; servopos.position_max 0.010000; ";
  EXPECT_EQ(wrong(read(driver, factory)), all);
  EXPECT_EQ(wrong(read(driver, factory, {}, 7)), all) << "every seventh answer is lost";
  moteus::MoteusEmulator documented = make_emulator(driver);
  EXPECT_EQ(wrong(read(driver, documented)), "");
}

TEST(DriverSettings, OfAMoteusThatBringUpReadsAreNamedToo) {
  const moteus::MoteusDriver driver = moteus_driver();
  moteus::MoteusSettings settings = moteus::documented_settings(driver);
  settings.timeout_mode = moteus::MoteusTimeout::hold_position;
  settings.bemf_feedforward = 0.5;
  settings.default_velocity_limit_rev_s = 2;
  moteus::MoteusEmulator emulator(driver, settings);
  EXPECT_EQ(
      wrong(read(driver, emulator)),
      "servo.default_velocity_limit 2.000000; servo.timeout_mode 10; servo.bemf_feedforward 0.500000; ");
}

TEST(DriverSettings, BoundsOfAMoteusMayLeaveTheTravel) {
  const moteus::MoteusDriver driver = moteus_driver();
  moteus::MoteusSettings settings = moteus::documented_settings(driver);
  settings.bounds = {.minimum_rev = -0.2, .maximum_rev = 0.3};
  moteus::MoteusEmulator emulator(driver, settings);
  bring_up::Options options;
  options.minimum_angle_rad = -1.5;
  options.maximum_angle_rad = 1.6;
  EXPECT_EQ(wrong(read(driver, emulator, options)), "");
  options.maximum_angle_rad = 1.7;
  EXPECT_EQ(wrong(read(driver, emulator, options)),
            "servopos.position_min -0.200000; servopos.position_max 0.300000; ");
}

TEST(DriverSettings, OfAnOdriveFromTheVendorAreAllNamedAtOnce) {
  const odrive::OdriveDriver driver{3, {0x191, 0x192, 0x193, 0x194, 0x00060b, 0x04043a}};
  bring_up::Options options;
  options.maximum_speed_rad_s = 15;
  odrive::OdriveEmulator factory(driver, {});
  EXPECT_EQ(wrong(read(driver, factory, options)),
            "axis0.controller.config.enable_torque_mode_vel_limit true; axis0.controller.config.vel_limit 2; "
            "axis0.config.can.encoder_msg_rate_ms 10; axis0.config.can.heartbeat_msg_rate_ms 100; "
            "axis0.config.can.torques_msg_rate_ms silent; ");
  odrive::OdriveEmulator documented(driver, odrive::documented_settings());
  EXPECT_EQ(wrong(read(driver, documented, options)), "");
  odrive::OdriveSettings every_second_tick = odrive::documented_settings();
  every_second_tick.estimates_period_ns = 2 * kMillisecond_ns;
  odrive::OdriveEmulator seldom(driver, every_second_tick);
  EXPECT_EQ(wrong(read(driver, seldom, options)), "axis0.config.can.encoder_msg_rate_ms 2; ");
  const odrive::OdriveDriver unknown{3, {0x191, 0x192, 0, 0, 0x00060b, 0x04043a}};
  EXPECT_EQ(read(unknown, documented).size(), 5u) << "limits whose endpoints are not known are not asked for";
  EXPECT_EQ(read(odrive::OdriveDriver{3, {}}, documented).size(), 3u) << "nor is a version without endpoints";
}

TEST(DriverSettings, OfAnOdriveOfAnotherVersionAreItsVersionAndNoEndpoints) {
  for (const auto& [firmware, hardware, expected] :
       {std::tuple(0x00060cu, 0x04043au, "firmware version 0.6.11; "),
        std::tuple(0x00060bu, 0x04043bu, "hardware version 4.4.58; ")}) {
    const odrive::OdriveDriver driver{3, {0x191, 0x192, 0x193, 0x194, firmware, hardware}};
    odrive::OdriveSettings settings = odrive::documented_settings();
    settings.velocity_limit_rev_s = 2;
    odrive::OdriveEmulator documented(driver, settings);
    EXPECT_EQ(wrong(read(driver, documented, {.maximum_speed_rad_s = 15})), expected);
  }
}

TEST(DriverSettings, OfAnAkOfVersionThreeAreWhatItSends) {
  const ak::AkDriver driver{.position_frames = true};
  ak::AkEmulator factory(driver, {});
  EXPECT_EQ(wrong(read(driver, factory)),
            "CAN feedback rate, Hz, 50; rate of position frames 0x2A, Hz, silent; ");
  ak::AkEmulator documented = ak::make_emulator(driver);
  EXPECT_EQ(wrong(read(driver, documented)), "");
  EXPECT_EQ(read(ak::AkDriver{}, documented).size(), 1u)
      << "position frames that are not wanted do not count";
}

TEST(DriverSettings, OfADamiaoAreItsRegistersAndTheOthersHaveNone) {
  mit::MitDriver driver;
  driver.reply_id = 0x11;
  driver.layout = mit::ReplyLayout::damiao;
  mit::MitEmulator emulator = mit::make_emulator(driver);
  EXPECT_EQ(wrong(read(driver, emulator)), "");
  mit::MitDriver configured = driver;
  configured.position_rad = {-3.2, 3.2};
  configured.torque_Nm = {-120, 120};
  EXPECT_EQ(wrong(read(configured, emulator)), "PMAX 12.5; TMAX 18; ");
  emulator.set_powered(false);
  EXPECT_EQ(wrong(read(driver, emulator)), "CTRL_MODE ; PMAX ; VMAX ; TMAX ; ") << "no answer";
  driver.layout = mit::ReplyLayout::ak;
  EXPECT_TRUE(read(driver, emulator).empty());
}

/// A repeated question has two answers. The second comes when the next register is asked already.
TEST(DriverSettings, ALateAnswerOfADamiaoIsNotThatOfTheNextRegister) {
  mit::MitDriver driver;
  driver.layout = mit::ReplyLayout::damiao;
  mit::MitSettingReader reader(driver, {});
  const auto answer = [&](mit::DamiaoRegister number, std::uint32_t bits) {
    CanFrame frame;
    EXPECT_EQ(mit::encode_register_answer(driver, {.number = static_cast<std::uint8_t>(number), .bits = bits},
                                          frame),
              EncodeStatus::ok);
    return frame;
  };
  const CanFrame mode = answer(mit::DamiaoRegister::control_mode, 1);
  ASSERT_TRUE(reader.next(false, false));
  EXPECT_TRUE(reader.take(mode));
  ASSERT_TRUE(reader.next(false, false));
  EXPECT_FALSE(reader.take(mode));
  const auto range = static_cast<float>(driver.position_rad.maximum);
  EXPECT_TRUE(reader.take(answer(mit::DamiaoRegister::position_range, std::bit_cast<std::uint32_t>(range))));
  EXPECT_EQ(wrong(reader.settings(0)), "VMAX ; TMAX ; ");
}

}  // namespace
}  // namespace stilt::hal
