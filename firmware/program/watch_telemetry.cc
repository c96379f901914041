#include "firmware/program/watch_telemetry.h"

#include <cmath>
#include <limits>

#include "firmware/telemetry/telemetry_node.h"

namespace stilt::program {

WatchTelemetry::WatchTelemetry(ControllerState& state, std::int64_t start_ns, double rate_hz)
    : state_(state), start_ns_(start_ns), operate_every_(static_cast<std::uint64_t>(rate_hz / 50.0) + 1) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  record_.state = supervisor::State::watch;
  record_.estimated_state.fill(kNan);  // where the hip is, is not known
}

WatchTelemetry::~WatchTelemetry() {
  if (state_.telemetry_node != nullptr) state_.telemetry_node->flush();
}

bool WatchTelemetry::follow(const commissioning::WatchSample& sample) {
  if (state_.telemetry_node == nullptr) return true;
  record_.time_ns = start_ns_ + std::llround(1e9 * sample.time_s);
  record_.joints = sample.readings.joints;
  record_.base = sample.readings.base;
  record_.emergency_stop = sample.readings.emergency_stop;
  record_.bus_errors = sample.readings.bus_errors;
  const auto set = [this](int position, double angle, double rate) {
    record_.estimated_state[static_cast<std::size_t>(position)] = angle;
    record_.estimated_state[static_cast<std::size_t>(model::kPositions + position)] = rate;
  };
  set(model::kFirstAngle, record_.base.pitch_rad, record_.base.pitch_rate_rad_s);
  for (int joint = 0; joint < model::kJoints; ++joint) {
    const hal::JointReading& reading = record_.joints[static_cast<std::size_t>(joint)];
    set(model::kFirstJoint + joint, reading.position_rad, reading.velocity_rad_s);
  }
  state_.telemetry_node->tick(record_);
  if (record_.tick++ % operate_every_ != 0) return true;
  publish(state_, state_.loop, state_.planning);
  const supervisor::RequestKind asked = state_.telemetry_node->operate({}).request.kind;
  return asked != supervisor::RequestKind::off && asked != supervisor::RequestKind::cut;
}

}  // namespace stilt::program
