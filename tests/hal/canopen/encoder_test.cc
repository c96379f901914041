#include "hal/canopen/encoder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "hal/canopen/encoder_emulator.h"
#include "tests/hal/hex.h"

namespace stilt::hal::canopen {
namespace {

using stilt::hal::testing::with_payload;

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr double kTurn_rad = 2 * std::numbers::pi;

/// An encoder that has been on for long, and who reads it, a tick apart, as over a bus.
class Pair {
 public:
  explicit Pair(const Encoder& configured, const Encoder& real, std::uint32_t period_reads = 1)
      : emulator(real), reader(configured, period_reads) {
    FrameSink boot_up;
    emulator.elapse(now_ns, boot_up);
  }
  explicit Pair(const Encoder& encoder, std::uint32_t period_reads = 1)
      : Pair(encoder, encoder, period_reads) {}

  /// A read, and what is sent after it.
  void tick() {
    now_ns += kTick_ns;
    got_position = false;
    if (!late) {
      for (const CanFrame& frame : arriving_)
        got_position = reader.take(now_ns, frame, position) == DecodeStatus::ok || got_position;
      arriving_.clear();
    }
    FrameSink replies;
    emulator.elapse(now_ns, replies);
    if (const auto frame = reader.step(now_ns)) {
      sent.push_back(*frame);
      if (connected) emulator.take(now_ns, *frame, replies);
    }
    if (connected) arriving_.insert(arriving_.end(), replies.frames().begin(), replies.frames().end());
  }
  /// Until a position comes. False: not in so many ticks.
  bool run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      tick();
      if (got_position) return true;
    }
    return false;
  }

  EncoderEmulator emulator;
  EncoderReader reader;
  std::int64_t now_ns = 1'000'000'000;
  EncoderPosition position;
  bool got_position = false;
  bool connected = true;
  bool late = false;  ///< whether replies are under way for longer
  std::vector<CanFrame> sent;

 private:
  std::vector<CanFrame> arriving_;
};

TEST(CanopenEncoder, AnEncoderWithFactorySettingsIsStartedAndReportsWithEverySync) {
  Pair pair(Encoder{.node = 5});
  pair.emulator.set_motion(0.25 * kTurn_rad, 0);
  ASSERT_TRUE(pair.run(150));
  EXPECT_NEAR(pair.position.angle_rad, 0.25 * kTurn_rad, kTurn_rad / 65536);
  EXPECT_TRUE(std::isnan(pair.position.speed_rad_s));
  EXPECT_EQ(pair.reader.trouble(), EncoderTrouble{});
  EXPECT_EQ(pair.position.time_ns, pair.now_ns - kTick_ns) << "of the SYNC that it was measured at";
  for (int i = 0; i < 100; ++i) {
    pair.tick();
    EXPECT_TRUE(pair.got_position) << i;
  }
}

TEST(CanopenEncoder, EveryQuestionIsAskedBeforeTheStart) {
  Pair pair(Encoder{.node = 5});
  ASSERT_TRUE(pair.run(150));
  std::vector<std::string> said;
  for (const CanFrame& frame : pair.sent) {
    if (frame.id != kSyncId) said.push_back(testing::hex(frame));
  }
  const std::vector<std::string> expected{"8005",              // pre-operational
                                          "4000100000000000",  // device type
                                          "4000650000000000",  // operating status
                                          "4001650000000000",  // steps
                                          "4002650000000000",  // turns
                                          "40001a0000000000",  // mapping
                                          "40001a0100000000",  //
                                          "4000180100000000",  // identifier
                                          "2f00180201000000",  // with every SYNC
                                          "2b17100064000000",  // heartbeat of 100 ms
                                          "0105"};             // start
  EXPECT_EQ(said, expected);
}

TEST(CanopenEncoder, SyncComesAsOftenAsTheSensorIsRead) {
  Pair pair(Encoder{.node = 5}, 4);
  ASSERT_TRUE(pair.run(150));
  int positions = 0;
  for (int i = 0; i < 100; ++i) {
    pair.tick();
    positions += pair.got_position ? 1 : 0;
  }
  EXPECT_EQ(positions, 25);
}

TEST(CanopenEncoder, PositionAndSpeedAreThoseOfTheShaft) {
  Pair pair(Encoder{.node = 5, .steps_per_turn = 8192, .turns = 4096, .speed_rad_s = 0.001});
  pair.emulator.set_motion(100.3 * kTurn_rad, -7.25);
  ASSERT_TRUE(pair.run(150));
  EXPECT_NEAR(pair.position.angle_rad, 100.3 * kTurn_rad, kTurn_rad / 8192);
  EXPECT_NEAR(pair.position.speed_rad_s, -7.25, 0.0005);
  pair.emulator.set_motion(-0.5 * kTurn_rad, 0);
  pair.tick();
  pair.tick();
  EXPECT_NEAR(pair.position.angle_rad, 4095.5 * kTurn_rad, kTurn_rad / 8192) << "repeats after its turns";
}

/// Bytes by hand: 0x00001000 of 65536 steps are 22.5 degrees; CiA 301: least significant byte first.
TEST(CanopenEncoder, APositionIsReadLeastSignificantByteFirst) {
  Pair pair(Encoder{.node = 5});
  ASSERT_TRUE(pair.run(150));
  EncoderPosition position;
  ASSERT_EQ(pair.reader.take(0, with_payload(classic_frame(0x185, 4), "00100000"), position),
            DecodeStatus::ok);
  EXPECT_DOUBLE_EQ(position.angle_rad, kTurn_rad / 16);
  EXPECT_EQ(pair.reader.take(0, with_payload(classic_frame(0x185, 3), "001000"), position),
            DecodeStatus::wrong_length);
  EXPECT_EQ(pair.reader.take(0, with_payload(classic_frame(0x186, 4), "00100000"), position),
            DecodeStatus::not_addressed);
}

struct Mistake {
  const char* name;
  std::function<void(EncoderEmulator&)> of;
  EncoderTrouble trouble;
  const char* sentence;
};

TEST(CanopenEncoder, AnEncoderThatIsNotAsConfiguredIsNamedAndReportsNothing) {
  const Mistake mistakes[] = {
      {"a drive",
       [](auto& e) { e.set_object(objects::kDeviceType, 0x00020192); },
       {0x00020192, 0x1000, 0, EncoderFailure::no_encoder},
       "torso sensor: node 5 is a device of profile 402, an encoder has 406; see torso_sensor.encoder_node"},
      {"other steps",
       [](auto& e) { e.set_object(objects::kSteps, 8192); },
       {8192, 0x6501, 0, EncoderFailure::wrong_steps},
       "torso sensor: node 5 has 8192 steps per turn (object 0x6501:0), torso_sensor.encoder_steps is 65536"},
      {"other turns",
       [](auto& e) { e.set_object(objects::kTurns, 4096); },
       {4096, 0x6502, 0, EncoderFailure::wrong_turns},
       "torso sensor: node 5 reads 4096 (object 0x6502:0), which is not the 1 turns of "
       "torso_sensor.encoder_turns"},
      {"scaled",
       [](auto& e) {
         e.set_object(objects::kOperatingStatus, kScalingOn);
         e.set_object(objects::kScaledSteps, 3600);
       },
       {3600, 0x6001, 0, EncoderFailure::wrong_steps},
       nullptr},
      {"scaled range",
       [](auto& e) {
         e.set_object(objects::kOperatingStatus, kScalingOn);
         e.set_object(objects::kScaledSteps, 65536);
         e.set_object(objects::kScaledRange, 131072);
       },
       {131072, 0x6002, 0, EncoderFailure::wrong_turns},
       nullptr},
      {"another mapping",
       [](auto& e) { e.set_object(objects::kPdoFirst, 0x60300110); },
       {0x60300110, 0x1a00, 1, EncoderFailure::wrong_mapping},
       nullptr},
      {"no mapping",
       [](auto& e) { e.set_object(objects::kPdoEntries, 0); },
       {0, 0x1a00, 0, EncoderFailure::wrong_mapping},
       nullptr},
      {"a PDO that is off",
       [](auto& e) { e.set_object(objects::kPdoIdentifier, 0x80000185); },
       {0x80000185, 0x1800, 1, EncoderFailure::wrong_identifier},
       nullptr},
      {"no synchronous PDO",
       [](auto& e) { e.remove_object(objects::kPdoTransmission); },
       {0x06020000, 0x1800, 2, EncoderFailure::aborted},
       "torso sensor: node 5 refuses what every encoder of CiA 406 has (object 0x1800:2), abort code "
       "0x06020000"},
  };
  for (const Mistake& mistake : mistakes) {
    SCOPED_TRACE(mistake.name);
    const Encoder encoder{.node = 5};
    Pair pair(encoder);
    mistake.of(pair.emulator);
    EXPECT_FALSE(pair.run(900));
    EXPECT_EQ(pair.reader.trouble(), mistake.trouble);
    EXPECT_FALSE(sentence(pair.reader.trouble(), encoder).empty());
    if (mistake.sentence != nullptr) {
      EXPECT_EQ(sentence(pair.reader.trouble(), encoder), mistake.sentence);
    }
  }
}

TEST(CanopenEncoder, ObjectsThatNotEveryEncoderHasMayBeMissing) {
  for (const Object& object : {objects::kOperatingStatus, objects::kSteps, objects::kTurns,
                               objects::kPdoIdentifier, objects::kHeartbeatTime}) {
    Pair pair(Encoder{.node = 5});
    pair.emulator.remove_object(object);
    EXPECT_TRUE(pair.run(200)) << object.index;
  }
}

TEST(CanopenEncoder, AScaledEncoderCountsItsScaledSteps) {
  Pair pair(Encoder{.node = 5, .steps_per_turn = 36000});
  pair.emulator.set_object(objects::kSteps, 65536);
  pair.emulator.set_object(objects::kOperatingStatus, kScalingOn);
  pair.emulator.set_object(objects::kScaledSteps, 36000);
  pair.emulator.set_object(objects::kScaledRange, 36000);
  EXPECT_TRUE(pair.run(200));
}

/// SIKO AP10, manual 86853, 5.7.2.56: of 0x2E8BA turns the object has the low 16 bits.
TEST(CanopenEncoder, MoreTurnsThanItsObjectHoldsAreComparedByTheLow16Bits) {
  Pair pair(Encoder{.node = 5, .steps_per_turn = 720, .turns = 0x2e8ba});
  pair.emulator.set_object(objects::kTurns, 0xe8ba);
  EXPECT_TRUE(pair.run(200));
}

TEST(CanopenEncoder, ASilentEncoderIsNamedAndAskedAgain) {
  const Encoder encoder{.node = 5};
  Pair pair(encoder);
  pair.connected = false;
  EXPECT_FALSE(pair.run(300));
  EXPECT_EQ(pair.reader.trouble(), (EncoderTrouble{0, 0x1000, 0, EncoderFailure::silent}));
  EXPECT_EQ(sentence(pair.reader.trouble(), encoder),
            "torso sensor: node 5 does not answer (object 0x1000:0); see torso_sensor.encoder_node, its bit "
            "rate, power and cable");
  pair.connected = true;
  EXPECT_TRUE(pair.run(1500));
  EXPECT_EQ(pair.reader.trouble(), EncoderTrouble{});
}

/// A question is repeated after 50 ms. The second answer comes when the next question is asked already.
TEST(CanopenEncoder, TwoLateAnswersToARepeatedQuestionAreNoAnswerToTheNext) {
  Pair pair(Encoder{.node = 5});
  pair.emulator.set_object(objects::kScaledSteps, 3600);  // its scaling is off
  pair.late = true;
  const auto asked = [&pair] {
    return std::ranges::count_if(
        pair.sent, [](const CanFrame& frame) { return frame == sdo_read_frame(5, objects::kDeviceType); });
  };
  for (int i = 0; i < 100 && asked() < 2; ++i) pair.tick();
  ASSERT_EQ(asked(), 2);
  pair.late = false;
  EXPECT_TRUE(pair.run(150));
  EXPECT_EQ(pair.reader.trouble(), EncoderTrouble{});
}

TEST(CanopenEncoder, AnEncoderThatWasWithoutPowerIsStartedAgainAtOnce) {
  Pair pair(Encoder{.node = 5});
  ASSERT_TRUE(pair.run(150));
  pair.emulator.power_cycle();
  pair.tick();
  EXPECT_TRUE(pair.run(120)) << "its boot-up message begins it anew";
}

TEST(CanopenEncoder, AnEncoderThatWasStoppedByAnotherIsStartedAgain) {
  Pair pair(Encoder{.node = 5});
  ASSERT_TRUE(pair.run(150));
  FrameSink nothing;
  pair.emulator.take(pair.now_ns, nmt_frame(NmtCommand::stop, 0), nothing);
  pair.tick();
  pair.tick();
  EXPECT_FALSE(pair.got_position);
  EXPECT_TRUE(pair.run(150)) << "its heartbeat says so within 100 ms";
}

TEST(CanopenEncoder, AnEncoderThatFallsSilentIsAskedFromTheBeginning) {
  Pair pair(Encoder{.node = 5});
  ASSERT_TRUE(pair.run(150));
  pair.connected = false;
  pair.tick();  // what is under way arrives
  EXPECT_FALSE(pair.run(230));
  EXPECT_EQ(pair.reader.trouble().failure, EncoderFailure::silent);
  pair.connected = true;
  EXPECT_TRUE(pair.run(300));
}

TEST(CanopenEncoder, AnEncoderThatMakesNoSenseIsInvalid) {
  EXPECT_TRUE(valid(Encoder{}));
  EXPECT_TRUE(valid(Encoder{.steps_per_turn = 65536, .turns = 65536}));
  EXPECT_FALSE(valid(Encoder{.node = 0}));
  EXPECT_FALSE(valid(Encoder{.node = 128}));
  EXPECT_FALSE(valid(Encoder{.steps_per_turn = 1}));
  EXPECT_FALSE(valid(Encoder{.turns = 0}));
  EXPECT_FALSE(valid(Encoder{.steps_per_turn = 65536, .turns = 65537}));
  EXPECT_FALSE(valid(Encoder{.speed_rad_s = std::nan("")}));
}

}  // namespace
}  // namespace stilt::hal::canopen
