#pragma once

#include <optional>
#include <vector>

#include "firmware/telemetry/messages.h"
#include "host_tools/recording/run_record.h"
#include "mpc_core/model/types.h"

namespace stilt::record {

/// The plans of a record, which holds some nodes of about ten per second, as they were in use.
class PlanTrack {
 public:
  /// What a plan contains for one time.
  struct Point {
    double base_x_m = 0.0, base_z_m = 0.0, pitch_rad = 0.0;
    model::JointVector joint_position_rad = model::JointVector::Zero();
    model::FeetVector contact_force_N = model::FeetVector::Zero();
    model::ContactMode mode;
  };

  /// Adds a plan; one whose sequences do not fit its count is left out. Plans come in the order of their
  /// start.
  void add(const telemetry::Plan& message);

  /// The newest plan that had begun, as far as it was not older than half a second; nothing without one.
  /// Positions are linear between its nodes; forces and contacts hold until the next node.
  [[nodiscard]] std::optional<Point> at(double time_s) const;

  /// All of them, for drawing.
  [[nodiscard]] std::vector<log::PlanSnapshot> snapshots() const;

 private:
  struct Node {
    double time_s = 0.0;
    Point point;
    model::FeetVector foot_position_m = model::FeetVector::Zero();
  };
  struct Plan {
    double start_s = 0.0;
    std::vector<Node> nodes;
  };
  std::vector<Plan> plans_;
};

}  // namespace stilt::record
