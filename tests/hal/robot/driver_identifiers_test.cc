#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "hal/mit/damiao_registers.h"
#include "hal/robot/wiring_load.h"

namespace stilt::hal {
namespace {

JointWiring mit_joint(std::uint16_t command_id, std::uint16_t reply_id, mit::ReplyLayout layout) {
  mit::MitDriver driver;
  driver.command_id = command_id;
  driver.reply_id = reply_id;
  driver.layout = layout;
  JointWiring joint;
  joint.driver = driver;
  return joint;
}

JointWiring moteus_joint(std::uint8_t id) {
  JointWiring joint;
  joint.driver = moteus::MoteusDriver{.id = id};
  return joint;
}

JointWiring odrive_joint(std::uint8_t node) {
  JointWiring joint;
  joint.driver = odrive::OdriveDriver{.node = node, .endpoints = {}};
  return joint;
}

bool collide(const NodeIdentifiers& a, const NodeIdentifiers& b) { return !collisions(a, b).empty(); }
bool collide(const JointWiring& a, const JointWiring& b) {
  return collide(identifiers(a.driver), identifiers(b.driver));
}
bool collide(const JointWiring& a, std::uint32_t sensor_id, bool extended = false) {
  return collide(identifiers(a.driver), identifiers(ChannelRow{.id = sensor_id, .extended = extended}));
}

TEST(NodeIdentifiers, PatternsOverlapWhenAnIdentifierFitsBoth) {
  const unsigned seed = 11;
  std::mt19937 generator(seed);
  const auto random = [&generator] { return static_cast<std::uint32_t>(generator()); };
  for (int trial = 0; trial < 300; ++trial) {
    const IdPattern a{.value = random() & 0x7ff, .mask = random() & 0x7ff};
    const IdPattern b{.value = random() & 0x7ff, .mask = random() & random() & 0x7ff};
    bool fits_both = false;
    for (std::uint32_t id = 0; id <= kMaximumStandardId; ++id) {
      fits_both = fits_both || (((id ^ a.value) & a.mask) == 0 && ((id ^ b.value) & b.mask) == 0);
    }
    EXPECT_EQ(overlap(a, b), fits_both) << "seed " << seed << ", trial " << trial;
  }
  EXPECT_FALSE(overlap({.value = 5}, {.value = 5, .standard = false, .extended = true}));
}

/// The frames that the codecs really send fit the patterns.
TEST(NodeIdentifiers, FramesOfTheCodecsAreAmongTheCommands) {
  const auto sent_to = [](const JointWiring& joint, const CanFrame& frame) {
    const IdPattern own{.value = frame.id, .standard = !frame.extended, .extended = frame.extended};
    const NodeIdentifiers node = identifiers(joint.driver);
    const auto fits = [&own](const IdPattern& pattern) { return overlap(pattern, own); };
    return std::ranges::any_of(node.commands, fits) && std::ranges::any_of(node.accepts, fits);
  };
  CanFrame frame;
  ASSERT_EQ(encode_command(moteus::MoteusDriver{.id = 9}, {}, frame), EncodeStatus::ok);
  EXPECT_TRUE(sent_to(moteus_joint(9), frame));
  EXPECT_FALSE(sent_to(moteus_joint(8), frame));
  ASSERT_EQ(odrive::encode_input_torque(6, 1, frame), EncodeStatus::ok);
  EXPECT_TRUE(sent_to(odrive_joint(6), frame));
  EXPECT_FALSE(sent_to(odrive_joint(7), frame));
  const JointWiring damiao = mit_joint(3, 0x13, mit::ReplyLayout::damiao);
  ASSERT_EQ(encode_command(std::get<mit::MitDriver>(damiao.driver), {}, frame), EncodeStatus::ok);
  EXPECT_TRUE(sent_to(damiao, frame));
}

TEST(NodeIdentifiers, DriversOfOneKindNeedTheirOwnIdentifiers) {
  using mit::ReplyLayout;
  EXPECT_TRUE(collide(odrive_joint(2), odrive_joint(2)));
  EXPECT_FALSE(collide(odrive_joint(2), odrive_joint(3)));
  EXPECT_TRUE(collide(moteus_joint(2), moteus_joint(2)));
  EXPECT_FALSE(collide(moteus_joint(2), moteus_joint(3)));
  EXPECT_FALSE(collide(moteus_joint(2), moteus_joint(100))) << "a long reply";
  EXPECT_TRUE(collide(mit_joint(1, 0, ReplyLayout::ak), mit_joint(1, 5, ReplyLayout::ak)));
  EXPECT_FALSE(collide(mit_joint(1, 0, ReplyLayout::ak), mit_joint(2, 0, ReplyLayout::ak)))
      << "a byte names the driver that replies";
  EXPECT_TRUE(collide(mit_joint(1, 0, ReplyLayout::ak), mit_joint(2, 0, ReplyLayout::damiao)))
      << "not across vendors";
  EXPECT_TRUE(collide(mit_joint(1, 2, ReplyLayout::damiao), mit_joint(2, 3, ReplyLayout::damiao)))
      << "answer and command";
}

TEST(NodeIdentifiers, DriversOfDifferentKindsMayCollideToo) {
  const JointWiring damiao = mit_joint(1, 0x11, mit::ReplyLayout::damiao);
  EXPECT_TRUE(collide(damiao, moteus_joint(1))) << "a moteus accepts whatever ends in its identifier";
  EXPECT_FALSE(collide(damiao, moteus_joint(2)));
  EXPECT_TRUE(collide(damiao, odrive_joint(0)));
  EXPECT_FALSE(collide(damiao, odrive_joint(1)));
}

TEST(NodeIdentifiers, FramesOfSensorsCollideWithDrivers) {
  EXPECT_TRUE(collide(odrive_joint(2), 0x40));
  EXPECT_TRUE(collide(odrive_joint(2), 0x5f));
  EXPECT_FALSE(collide(odrive_joint(2), 0x3f));
  EXPECT_FALSE(collide(odrive_joint(2), 0x60));
  EXPECT_FALSE(collide(odrive_joint(2), 0x50, true)) << "an ODrive takes short identifiers only";
  EXPECT_TRUE(collide(odrive_joint(2), 0x7e2)) << "every ODrive accepts node 63";
  EXPECT_TRUE(collide(moteus_joint(7), 0x700)) << "its answer";
  EXPECT_TRUE(collide(moteus_joint(7), 0x107)) << "a command to it";
  EXPECT_FALSE(collide(moteus_joint(7), 0x108));
  EXPECT_TRUE(collide(mit_joint(1, 0x11, mit::ReplyLayout::damiao), mit::kDamiaoRegisterId));
  EXPECT_FALSE(collide(mit_joint(1, 0x11, mit::ReplyLayout::ak), mit::kDamiaoRegisterId));
}

TEST(NodeIdentifiers, PatternsAreDescribedForPeople) {
  EXPECT_EQ(describe({.value = 0x150}), "identifier 0x150");
  EXPECT_EQ(describe(identifiers(odrive_joint(2).driver).accepts[0]), "identifiers 0x40 to 0x5f");
  EXPECT_EQ(describe(identifiers(moteus_joint(5).driver).accepts[0]),
            "identifiers that end in the 8 bits 0x5");
}

}  // namespace
}  // namespace stilt::hal
