#pragma once

namespace stilt::ocp {

/// A monotonic clock in nanoseconds, for measurements only: results never depend on it.
using ClockFunction = long long (*)() noexcept;

}  // namespace stilt::ocp
