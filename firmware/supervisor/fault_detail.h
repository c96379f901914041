#pragma once

#include <cstdint>
#include <limits>

#include "firmware/supervisor/detectors.h"

namespace stilt::supervisor {

/// What a fault was found by: of all joints with it, the first.
struct FaultDetail {
  int joint = -1;  ///< hip_L, knee_L, hip_R, knee_R from 0; -1: none in particular
  hal::DriverFault driver_fault = hal::DriverFault::none;
  std::uint32_t fault_code = 0;                             ///< vendor code of `driver_fault`
  double value = std::numeric_limits<double>::quiet_NaN();  ///< that crossed its limit; NaN: no number did
  double limit = std::numeric_limits<double>::quiet_NaN();  ///< margin included
  const char* unit = "";                                    ///< of both
  int bus = -1;                ///< number in hardware.buses, the first with the fault; -1: none in particular
  const char* condition = "";  ///< which of the fault's conditions, or what of the joint; may be empty
};

/// The detail of a fault that detect() has found in what was seen. Pure, real-time safe.
[[nodiscard]] FaultDetail detail(Fault fault, const Observation& seen, const JointLimits& limits,
                                 const SupervisorParameters& parameters) noexcept;

}  // namespace stilt::supervisor
