#include "hal/sensors/emergency_stop.h"

#include <gtest/gtest.h>

namespace stilt::hal {
namespace {

TEST(EmergencyStop, ANumberThatIsNoStateHasAName) {
  for (std::size_t number = kEmergencyStopStates; number < 256; ++number) {
    EXPECT_STREQ(name(static_cast<EmergencyStopState>(number)), "unknown");
  }
  EXPECT_STREQ(name(EmergencyStopState::absent), "not configured");
}

}  // namespace
}  // namespace stilt::hal
