#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/bring_up/bring_up.h"
#include "hal/driver_fault.h"

namespace stilt::hardware {

/// How far the motor drivers are on their way from powered to obeying.
struct DriversProgress {
  bool ready = false;   ///< all four are enabled, at zero torque
  bool failed = false;  ///< one cannot be; the others are not asked any further
  /// The driver at work, or the one that failed, and where.
  std::size_t joint = 0;
  hal::bring_up::Stage stage = hal::bring_up::Stage::identify;
  hal::bring_up::Failure failure = hal::bring_up::Failure::none;
  hal::DriverFault fault = hal::DriverFault::none;
};

/// Brings the four motor drivers up. No call waits, allocates, locks or throws.
class Drivers {
 public:
  /// Starts over, from whatever state the drivers are in.
  virtual void begin() noexcept = 0;

  /// One step, once a tick, after the buses were read and instead of a command. Keeps the drivers that are
  /// ready content with commands of zero torque.
  [[nodiscard]] virtual DriversProgress step(std::int64_t now_ns) noexcept = 0;

 protected:
  ~Drivers() = default;
};

}  // namespace stilt::hardware
