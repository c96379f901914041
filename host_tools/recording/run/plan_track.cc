#include "host_tools/recording/run/plan_track.h"

#include <algorithm>
#include <iterator>

#include "firmware/telemetry/cdr.h"

namespace stilt::record {
namespace {

constexpr double kLongestUse_s = 0.5;

}  // namespace

void PlanTrack::add(const telemetry::Plan& message) {
  using telemetry::span_of;
  const std::size_t count = message.count;
  const auto time_s = span_of(message.time_s);
  const auto contact = span_of(message.contact);
  const auto base = span_of(message.base);
  const auto joints = span_of(message.joint_position_rad);
  const auto feet = span_of(message.foot_position_m);
  const auto forces = span_of(message.contact_force_N);
  const bool fits = time_s.size() == count && contact.size() == count && base.size() == 3 * count &&
                    joints.size() == 4 * count && feet.size() == 4 * count && forces.size() == 4 * count;
  if (!fits || count < 2) return;
  Plan plan{message.start_time_s, {}};
  for (std::size_t i = 0; i < count; ++i) {
    Node node;
    node.time_s = message.start_time_s + time_s[i];
    node.point.base_x_m = base[3 * i];
    node.point.base_z_m = base[3 * i + 1];
    node.point.pitch_rad = base[3 * i + 2];
    for (std::size_t k = 0; k < 4; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      node.point.joint_position_rad[row] = joints[4 * i + k];
      node.point.contact_force_N[row] = forces[4 * i + k];
      node.foot_position_m[row] = feet[4 * i + k];
    }
    node.point.mode = {(contact[i] & 1u) != 0, (contact[i] & 2u) != 0};
    plan.nodes.push_back(node);
  }
  plans_.push_back(std::move(plan));
}

std::optional<PlanTrack::Point> PlanTrack::at(double time_s) const {
  const auto later = std::ranges::upper_bound(plans_, time_s, {}, &Plan::start_s);
  if (later == plans_.begin()) return std::nullopt;
  const Plan& plan = *std::prev(later);
  if (time_s > plan.start_s + kLongestUse_s || time_s > plan.nodes.back().time_s) return std::nullopt;
  const auto next = std::ranges::upper_bound(plan.nodes, time_s, {}, &Node::time_s);
  if (next == plan.nodes.begin() || next == plan.nodes.end()) return plan.nodes.back().point;
  const Node& from = *std::prev(next);
  const double share = (time_s - from.time_s) / (next->time_s - from.time_s);
  const auto between = [share](double a, double b) { return a + share * (b - a); };
  Point point = from.point;
  point.base_x_m = between(from.point.base_x_m, next->point.base_x_m);
  point.base_z_m = between(from.point.base_z_m, next->point.base_z_m);
  point.pitch_rad = between(from.point.pitch_rad, next->point.pitch_rad);
  point.joint_position_rad += share * (next->point.joint_position_rad - from.point.joint_position_rad);
  return point;
}

std::vector<log::PlanSnapshot> PlanTrack::snapshots() const {
  std::vector<log::PlanSnapshot> all;
  for (const Plan& plan : plans_) {
    log::PlanSnapshot& snapshot = all.emplace_back();
    snapshot.time_s = plan.start_s;
    for (const Node& node : plan.nodes) {
      snapshot.node_time_s.push_back(node.time_s);
      snapshot.base_x_m.push_back(node.point.base_x_m);
      snapshot.base_z_m.push_back(node.point.base_z_m);
      snapshot.pitch_rad.push_back(node.point.pitch_rad);
      snapshot.foot_position_m.push_back(node.foot_position_m);
    }
  }
  return all;
}

}  // namespace stilt::record
