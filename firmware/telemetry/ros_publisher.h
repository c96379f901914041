#pragma once

#include <string>

#include "firmware/control_loop/tick_record.h"
#include "firmware/diagnostics/event_text.h"
#include "firmware/diagnostics/statistics.h"
#include "firmware/telemetry/wall_time.h"
#include "firmware/telemetry/writer.h"

namespace stilt::telemetry {

/// What ROS 2 tools understand: joint_states, odom, diagnostics. Ordinary threads.
///
/// odom: frame "odom", x forward, z up, origin where the robot got on its feet. Child "base", at the hip,
/// turned by the pitch about +y. The twist is in the child's frame, as ROS 2 asks. Covariances are 0:
/// unknown. None is sent while the robot is off its feet, or its estimate is not finite: the place of the
/// base is unknown.
class RosPublisher {
 public:
  [[nodiscard]] static std::expected<RosPublisher, std::string> open(const Participant& participant);

  void joint_states(const control_loop::TickRecord& tick, const WallTime& time);
  void odometry(const control_loop::TickRecord& tick, const WallTime& time);
  void diagnostics(const control_loop::TickRecord& tick, const diagnostics::LoopStatistics& loop,
                   const diagnostics::PlannerStatistics& planning, const WallTime& time,
                   const std::string& robot, const diagnostics::FoundWords& found);

 private:
  Writer<JointState> joint_states_;
  Writer<Odometry> odometry_;
  Writer<DiagnosticArray> diagnostics_;
};

}  // namespace stilt::telemetry
