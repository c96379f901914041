#include "mpc_core/gait/gait_library.h"

#include <algorithm>
#include <cmath>

namespace stilt::gait {
namespace {

template <int Rows, int Columns>
void mix(const double (&a)[Rows][Columns], const double (&b)[Rows][Columns], double share,
         double (&result)[Rows][Columns]) noexcept {
  for (int r = 0; r < Rows; ++r) {
    for (int c = 0; c < Columns; ++c) result[r][c] = a[r][c] + share * (b[r][c] - a[r][c]);
  }
}

double mix(double a, double b, double share) noexcept { return a + share * (b - a); }

void mix_outputs(const HzdGait& a, const HzdGait& b, double share, HzdGait& result) noexcept {
  const double way_a = a.outputs.phase_end - a.outputs.phase_start;
  const double way_b = b.outputs.phase_end - b.outputs.phase_start;
  const bool same_shape = a.outputs.phase == b.outputs.phase && a.outputs.degree == b.outputs.degree;
  if (!same_shape || way_a * way_b <= 0.0) {  // between two directions a phase would stand still
    const HzdGait& nearer = share < 0.5 ? a : b;
    result.outputs = nearer.outputs;
    result.feedback = nearer.feedback;
    return;
  }
  result.outputs.phase = a.outputs.phase;
  result.outputs.degree = a.outputs.degree;
  result.outputs.phase_start = mix(a.outputs.phase_start, b.outputs.phase_start, share);
  result.outputs.phase_end = mix(a.outputs.phase_end, b.outputs.phase_end, share);
  mix(a.outputs.angle_rad, b.outputs.angle_rad, share, result.outputs.angle_rad);
  result.feedback.kp_1_s2 = mix(a.feedback.kp_1_s2, b.feedback.kp_1_s2, share);
  result.feedback.kd_1_s = mix(a.feedback.kd_1_s, b.feedback.kd_1_s, share);
  for (int i = 0; i < kReducedStates; ++i) {
    result.feedback.placement[i] = mix(a.feedback.placement[i], b.feedback.placement[i], share);
  }
}

}  // namespace

LibraryStatus GaitLibrary::add(const HzdGait& gait) noexcept {
  if (count_ == kMaxGaits) return LibraryStatus::full;
  if (gait.motion.degree < 2 || !(gait.step_time_s > 0.0)) return LibraryStatus::motion_unknown;
  if (count_ > 0) {
    if (!(gait.speed_m_s > gaits_[count_ - 1].speed_m_s)) return LibraryStatus::speeds_not_rising;
    const bool same_time = std::abs(gait.step_time_s - gaits_[0].step_time_s) <= kStepTimeTolerance_s;
    if (!same_time || gait.motion.degree != gaits_[0].motion.degree) return LibraryStatus::another_shape;
  }
  gaits_[count_++] = gait;
  return LibraryStatus::ok;
}

GaitLibrary::Neighbours GaitLibrary::around(double speed_m_s) const noexcept {
  int above = 0;
  while (above < count_ && gaits_[above].speed_m_s < speed_m_s) ++above;
  const int slower = std::max(above - 1, 0);
  const int faster = std::min(above, count_ - 1);
  const double gap = gaits_[faster].speed_m_s - gaits_[slower].speed_m_s;
  return {slower, faster, gap > 0.0 ? (speed_m_s - gaits_[slower].speed_m_s) / gap : 0.0};
}

GaitPoint GaitLibrary::motion_at(double speed_m_s, double s) const noexcept {
  const Neighbours near = around(speed_m_s);
  GaitPoint point = gait::motion_at(gaits_[near.slower], s);
  if (near.share == 0.0) return point;
  const GaitPoint faster = gait::motion_at(gaits_[near.faster], s);
  point.position += near.share * (faster.position - point.position);
  point.velocity += near.share * (faster.velocity - point.velocity);
  point.acceleration += near.share * (faster.acceleration - point.acceleration);
  point.torque_Nm += near.share * (faster.torque_Nm - point.torque_Nm);
  point.force_N += near.share * (faster.force_N - point.force_N);
  return point;
}

void GaitLibrary::blend(double speed_m_s, HzdGait& result) const noexcept {
  const Neighbours near = around(speed_m_s);
  const HzdGait& a = gaits_[near.slower];
  const HzdGait& b = gaits_[near.faster];
  const double share = near.share;
  result.speed_m_s = mix(a.speed_m_s, b.speed_m_s, share);
  result.step_time_s = mix(a.step_time_s, b.step_time_s, share);
  result.step_length_m = mix(a.step_length_m, b.step_length_m, share);
  result.motion.degree = a.motion.degree;
  mix(a.motion.position, b.motion.position, share, result.motion.position);
  mix(a.motion.torque_Nm, b.motion.torque_Nm, share, result.motion.torque_Nm);
  mix(a.motion.force_N, b.motion.force_N, share, result.motion.force_N);
  mix_outputs(a, b, share, result);
}

}  // namespace stilt::gait
