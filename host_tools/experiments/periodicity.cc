#include "host_tools/experiments/periodicity.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stilt::experiments {
namespace {

constexpr int kShares = 50;
using Shape = Eigen::Matrix<double, model::kJoints, kShares>;

/// Joint angles at a time, interpolated between neighbouring samples.
model::JointVector angles_at(const std::vector<log::RunSample>& samples, double time_s) {
  const auto after = std::ranges::lower_bound(samples, time_s, {}, &log::RunSample::time_s);
  const auto later = std::clamp(after, samples.begin() + 1, samples.end() - 1);
  const log::RunSample& a = *(later - 1);
  const log::RunSample& b = *later;
  const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
  const auto joints = [](const log::RunSample& sample) {
    return sample.true_state.segment<model::kJoints>(model::kFirstJoint);
  };
  return (1.0 - share) * joints(a) + share * joints(b);
}

/// Shape of the step that begins when the stance foot comes down, stance leg first.
Shape shape_of(const std::vector<log::RunSample>& samples, double start_s, double end_s,
               bool stance_is_left) {
  Shape shape;
  for (int i = 0; i < kShares; ++i) {
    const model::JointVector angles = angles_at(samples, start_s + (end_s - start_s) * i / kShares);
    shape.col(i) << angles.segment<2>(stance_is_left ? 0 : 2), angles.segment<2>(stance_is_left ? 2 : 0);
  }
  return shape;
}

}  // namespace

Periodicity periodicity(const log::RunRecord& record, double from_s) {
  const std::vector<log::Step>& steps = record.summary.steps;
  std::vector<Shape> shapes;
  for (std::size_t i = 0; i + 1 < steps.size() && record.samples.size() > 1; ++i) {
    if (steps[i].time_s < from_s || steps[i].foot == steps[i + 1].foot) continue;
    shapes.push_back(shape_of(record.samples, steps[i].time_s, steps[i + 1].time_s, steps[i].foot == "L"));
  }
  Periodicity result;
  result.steps = static_cast<int>(shapes.size());
  if (shapes.size() < 2) return result;
  const double count = static_cast<double>(shapes.size());
  Shape mean = Shape::Zero();
  for (const Shape& shape : shapes) mean += shape / count;
  Shape variance = Shape::Zero();
  for (const Shape& shape : shapes) variance += (shape - mean).cwiseAbs2() / (count - 1.0);
  result.rms_rad = std::sqrt(variance.mean());
  result.largest_rad = std::sqrt(variance.maxCoeff());
  return result;
}

}  // namespace stilt::experiments
