// Signals stop the robot though housekeeping waits for a terminal or a disk.
#include <gtest/gtest.h>

#include "tests/firmware/control_loop/rig.h"

namespace stilt::control_loop {
namespace {

using supervisor::RequestKind;
using supervisor::State;

class StopSignalsTest : public testing::RigTest {};

TEST_F(StopSignalsTest, ASignalShutsDownWithoutHousekeepingAndIsInTheRecord) {
  rig->stand();
  rig->mail.stops.shut_down = true;
  rig->run(1);
  EXPECT_TRUE(rig->record.command.shut_down);
  EXPECT_EQ(rig->record.command.request.number, rig->command.request.number);
  rig->run(6000);
  EXPECT_EQ(rig->state(), State::off);
}

TEST_F(StopSignalsTest, ASignalCutsWithoutHousekeepingAndIsInTheRecord) {
  rig->stand();
  rig->mail.stops.cut = true;
  rig->run(1);
  EXPECT_EQ(rig->record.command.request.kind, RequestKind::cut);
  EXPECT_EQ(rig->state(), State::off);
  EXPECT_EQ(rig->record.action, supervisor::Action::disable);
}

}  // namespace
}  // namespace stilt::control_loop
