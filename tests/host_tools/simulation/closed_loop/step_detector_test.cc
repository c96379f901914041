#include "host_tools/simulation/closed_loop/step_detector.h"

#include <gtest/gtest.h>

namespace stilt::simulation {
namespace {

/// Feeds one millisecond after the other with the left foot loaded or not, the right one always loaded.
class LeftFoot {
 public:
  explicit LeftFoot(StepDetector& detector) : detector_(detector) {}

  void hold(bool loaded, double duration_s) {
    for (int i = 0; i < static_cast<int>(duration_s * 1000.0 + 0.5); ++i) {
      detector_.update(time_s_, {0.0, loaded ? 100.0 : 0.0, 0.0, 100.0}, {0.7, 0.0, 0.4, 0.0}, 0.5);
      time_s_ += 0.001;
    }
  }

 private:
  StepDetector& detector_;
  double time_s_ = 0.0;
};

TEST(StepDetector, AStepIsTheTouchDownAfterASwing) {
  StepDetector detector;
  LeftFoot foot(detector);
  foot.hold(true, 0.2);
  foot.hold(false, 0.3);
  foot.hold(true, 0.2);
  ASSERT_EQ(detector.steps().size(), 1u);
  EXPECT_NEAR(detector.steps()[0].time_s, 0.5, 1e-9);
  EXPECT_EQ(detector.steps()[0].foot, "L");
  EXPECT_NEAR(detector.steps()[0].length_m, 0.3, 1e-12);
  EXPECT_EQ(detector.steps()[0].hip_x_m, 0.5);
}

TEST(StepDetector, ABounceIsNoStep) {
  StepDetector detector;
  LeftFoot foot(detector);
  foot.hold(true, 0.1);
  foot.hold(false, 0.3);
  foot.hold(true, 0.005);
  foot.hold(false, 0.02);
  foot.hold(true, 0.1);
  EXPECT_EQ(detector.steps().size(), 1u);
}

}  // namespace
}  // namespace stilt::simulation
