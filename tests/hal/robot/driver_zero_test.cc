#include "hal/robot/driver_zero.h"

#include <gtest/gtest.h>

#include <numbers>
#include <optional>

#include "hal/ak/ak_emulator.h"
#include "hal/mit/mit_emulator.h"
#include "hal/moteus/moteus_driver.h"
#include "hal/moteus/moteus_emulator.h"
#include "hal/robot/emulated_joint.h"

// What a driver keeps of a zero. Every protocol: tests/firmware/commissioning/zero_test.cc
namespace stilt::hal {
namespace {

/// Position by a query.
double position_rad(const moteus::MoteusDriver& driver, moteus::MoteusEmulator& emulator) {
  CanFrame question;
  FrameSink replies;
  EXPECT_EQ(encode_query(driver, moteus::MoteusQuery::state, question), EncodeStatus::ok);
  emulator.take(1'000'000'000, question, replies);
  moteus::MoteusReply reply;
  if (replies.frames().empty() || decode_reply(driver, replies.frames()[0], reply) != DecodeStatus::ok) {
    return 1e9;
  }
  return reply.position_rad;
}

TEST(DriverZero, OfAMoteusIsWrittenAndStaysWithoutPower) {
  const moteus::MoteusDriver driver;
  moteus::MoteusEmulator emulator(driver);
  emulator.motor.position_rad = 0.5;
  EXPECT_NEAR(position_rad(driver, emulator), 0.5, 1e-4);
  moteus::MoteusZero zero(driver);
  ZeroProgress progress = ZeroProgress::more;
  for (int frame = 0; frame < 100 && progress != ZeroProgress::done; ++frame) {
    FrameSink replies;
    emulator.take(1'000'000 * (frame + 1), zero.next(false), replies);
    for (const CanFrame& reply : replies.frames()) progress = zero.take(reply);
    ASSERT_NE(progress, ZeroProgress::failed);
  }
  EXPECT_EQ(progress, ZeroProgress::done);
  EXPECT_NEAR(position_rad(driver, emulator), 0.0, 1e-4);
  emulator.power_cycle();
  EXPECT_NEAR(position_rad(driver, emulator), 0.0, 1e-4);
}

/// Times that a command came to the command line of a moteus.
struct Commands {
  const moteus::MoteusDriver& driver;
  int writes = 0;
  int zeros = 0;

  void count(const CanFrame& frame) {
    const auto text = decode_console_request(driver, frame);
    if (text && text->view().starts_with("conf write\n")) ++writes;
    if (text && text->view().starts_with("d exact 0\n")) ++zeros;
  }
};

/// A frame is lost that has no answer after 20 ms, as for stiltd zero.
TEST(DriverZero, OfAMoteusThatIsDeafWhileItWritesItsFlashIsWrittenOnce) {
  constexpr std::int64_t kMillisecond_ns = 1'000'000;
  constexpr int kAnswer_ms = 20;
  for (const std::int64_t deaf_ms : {25, 60, 300}) {
    for (const bool answers_afterwards : {false, true}) {
      const moteus::MoteusDriver driver;
      moteus::MoteusEmulator emulator(driver);
      emulator.motor.position_rad = 0.5;
      emulator.set_flash(deaf_ms * kMillisecond_ns, answers_afterwards);
      moteus::MoteusZero zero(driver);
      ZeroProgress progress = ZeroProgress::more;
      Commands commands{driver};
      bool lost = false;
      std::int64_t now_ns = 1'000'000'000;
      for (int frames = 0; frames < 200 && progress == ZeroProgress::more; ++frames) {
        const CanFrame question = zero.next(lost);
        commands.count(question);
        FrameSink replies;
        emulator.take(now_ns, question, replies);
        lost = true;
        for (int wait_ms = 0; wait_ms < kAnswer_ms && lost; ++wait_ms) {
          now_ns += kMillisecond_ns;
          emulator.elapse(now_ns, replies);
          lost = replies.frames().empty();
        }
        for (const CanFrame& reply : replies.frames()) {
          if (progress == ZeroProgress::more) progress = zero.take(reply);
        }
      }
      EXPECT_EQ(progress, ZeroProgress::done) << deaf_ms;
      EXPECT_EQ(commands.writes, 1) << deaf_ms;
      EXPECT_EQ(commands.zeros, 1) << deaf_ms;
      emulator.power_cycle();
      EXPECT_NEAR(position_rad(driver, emulator), 0.0, 1e-4) << deaf_ms;
    }
  }
}

/// Its first reply that carries text after `conf write` is lost.
TEST(DriverZero, OfAMoteusWhoseAnswerIsLostIsNotWrittenAgain) {
  const moteus::MoteusDriver driver;
  moteus::MoteusEmulator emulator(driver);
  moteus::MoteusZero zero(driver);
  ZeroProgress progress = ZeroProgress::more;
  Commands commands{driver};
  bool lose = false;
  bool lost = false;
  for (int frame = 0; frame < 1000 && progress != ZeroProgress::unread; ++frame) {
    const CanFrame question = zero.next(lost);
    const int before = commands.writes;
    commands.count(question);
    lose = lose || commands.writes == before + 1;
    FrameSink replies;
    emulator.take(1'000'000 * (frame + 1), question, replies);
    lost = true;
    for (const CanFrame& reply : replies.frames()) {
      const auto answer = decode_console(driver, reply);
      const bool carries = answer && !answer->view().empty();
      if (lose && carries) {
        lose = false;
        continue;
      }
      progress = zero.take(reply);
      lost = false;
    }
  }
  EXPECT_EQ(progress, ZeroProgress::unread);
  EXPECT_EQ(commands.writes, 1) << "flash wears";
}

/// A conversation with an AK of version 3, of which so many reports arrive after the frame of its zero.
struct AkConversation {
  int limp = 0;     ///< commands before the first write
  int written = 0;  ///< times
  ZeroProgress progress = ZeroProgress::more;
};

AkConversation zero_of_ak(ak::AkEmulator& emulator, int silent_frames) {
  ak::AkZero zero{ak::AkDriver{}};
  AkConversation result;
  bool lost = false;
  std::int64_t now_ns = 1'000'000'000;
  for (int frames = 0; frames < 200 && result.progress != ZeroProgress::done; ++frames) {
    const CanFrame frame = zero.next(lost);
    if (frame.id == 0x568) ++result.written;
    if (result.written == 0) ++result.limp;
    FrameSink replies;
    emulator.take(now_ns += 2'100'000, frame, replies);
    emulator.elapse(now_ns, replies);
    lost = true;
    for (const CanFrame& report : replies.frames()) {
      if (result.written > 0 && silent_frames-- > 0) continue;
      const ZeroProgress progress = zero.take(report);
      if (progress == ZeroProgress::none) continue;
      lost = false;
      result.progress = progress;
    }
  }
  return result;
}

TEST(DriverZero, OfAnAkOfVersionThreeIsWrittenOnceItIsLimpAndSeldomMore) {
  ak::AkEmulator emulator = ak::make_emulator(ak::AkDriver{});
  emulator.motor.position_rad = 0.5;
  AkConversation result = zero_of_ak(emulator, 0);
  EXPECT_EQ(result.progress, ZeroProgress::done);
  EXPECT_GE(result.limp, 3);
  EXPECT_EQ(result.written, 1);
  emulator.motor.position_rad = 1;
  result = zero_of_ak(emulator, 60);
  EXPECT_EQ(result.progress, ZeroProgress::done);
  EXPECT_LE(result.written, 4) << "flash wears";
}

TEST(DriverZero, OfAnAkThatKeepsItsPositionIsNotDone) {
  ak::AkZero zero{ak::AkDriver{}};
  CanFrame status;
  ASSERT_EQ(encode_status(ak::AkDriver{}, {.position_rad = 0.5}, status), EncodeStatus::ok);
  ZeroProgress progress = ZeroProgress::more;
  for (int frames = 0; frames < 50; ++frames) {
    static_cast<void>(zero.next(frames > 3));
    progress = zero.take(status);
  }
  EXPECT_EQ(progress, ZeroProgress::none);
}

TEST(DriverZero, AnOdriveHasNone) {
  EXPECT_FALSE(make_zero(odrive::OdriveDriver{}));
  EXPECT_TRUE(make_zero(mit::MitDriver{}));
}

/// It is deaf while it writes its flash, and the first answer has the position of before.
TEST(DriverZero, OfADriverInMitModeIsGivenOnce) {
  const mit::MitDriver driver;
  mit::MitEmulator emulator(driver);
  emulator.motor.position_rad = 0.5;
  mit::MitZero zero(driver);
  ZeroProgress progress = ZeroProgress::more;
  std::optional<CanFrame> old_answer;
  int given = 0;
  for (int frame = 0; frame < 100 && progress != ZeroProgress::done; ++frame) {
    const CanFrame question = zero.next(given > 0);
    const bool writes = question.data[7] == static_cast<std::uint8_t>(mit::MitSpecial::set_zero);
    FrameSink replies;
    emulator.take(20'000'000 * (frame + 1), question, replies);
    if (writes) {
      ++given;
      ASSERT_TRUE(old_answer);
      progress = zero.take(*old_answer);
      EXPECT_EQ(progress, ZeroProgress::more);
      continue;
    }
    for (const CanFrame& reply : replies.frames()) {
      if (given == 0) old_answer = reply;
      progress = zero.take(reply);
    }
  }
  EXPECT_EQ(progress, ZeroProgress::done);
  EXPECT_EQ(given, 1);
}

/// What an emulated driver reports that gets its power while its shaft is there.
double after_power_up_rad(const JointDriver& any, double shaft_rad) {
  return visit_driver(any, [shaft_rad](const auto& driver) {
    auto emulator = make_emulator(driver);
    emulator.motor.position_rad = shaft_rad;
    emulator.power_cycle();
    CanFrame off;
    EXPECT_EQ(disable_frame(driver, off), EncodeStatus::ok);
    FrameSink replies;
    emulator.take(1'000'000'000, off, replies);
    emulator.elapse(1'000'000'000, replies);
    DriverReading reading;
    for (const CanFrame& reply : replies.frames()) static_cast<void>(take_frame(driver, reply, reading));
    return reading.position_rad;
  });
}

TEST(EmulatedZero, IsLostWithoutPowerAsTheDocumentsSay) {
  constexpr double kTurn_rad = 2 * std::numbers::pi / 9;  // of a rotor at its shaft
  mit::MitDriver driver;
  driver.layout = mit::ReplyLayout::damiao;
  EXPECT_NEAR(after_power_up_rad(driver, 1), 1, 1e-3);
  for (const mit::ReplyLayout layout : {mit::ReplyLayout::ak, mit::ReplyLayout::mini_cheetah}) {
    driver.layout = layout;
    EXPECT_NEAR(after_power_up_rad(driver, 0.3), 0.3, 1e-3);
    EXPECT_NEAR(after_power_up_rad(driver, 1), 1 - kTurn_rad, 1e-3);
  }
  EXPECT_NEAR(after_power_up_rad(moteus::MoteusDriver{}, 1), 1, 1e-3);
  EXPECT_NEAR(after_power_up_rad(odrive::OdriveDriver{}, 1), 0, 1e-6);
  EXPECT_NEAR(after_power_up_rad(ak::AkDriver{}, 1), 1 - kTurn_rad, ak::kAkStatusStep_rad);
}

}  // namespace
}  // namespace stilt::hal
