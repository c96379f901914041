#pragma once

#include <cstdint>

#include "firmware/commissioning/watch.h"
#include "firmware/control_loop/tick_record.h"
#include "firmware/program/controller_state.h"

namespace stilt::program {

/// The watched robot on the host's page. Somebody there may end the watch, and nothing else: no state follows
/// from `watch`. Without telemetry it does nothing.
class WatchTelemetry {
 public:
  /// @param rate_hz  of the ticks
  WatchTelemetry(ControllerState& state, std::int64_t start_ns, double rate_hz);
  ~WatchTelemetry();
  WatchTelemetry(const WatchTelemetry&) = delete;
  WatchTelemetry& operator=(const WatchTelemetry&) = delete;

  /// A tick. False: `off` or `cut` was commanded.
  [[nodiscard]] bool follow(const commissioning::WatchSample& sample);

 private:
  ControllerState& state_;
  std::int64_t start_ns_;
  std::uint64_t operate_every_;  ///< ticks
  control_loop::TickRecord record_;
};

}  // namespace stilt::program
