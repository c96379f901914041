#pragma once

#include <Eigen/Core>

/// Checks what a caller must ensure or an algorithm has proved: ends the program with file, line and
/// condition when it is false. Only in builds of type Debug. Release builds compile it, so that it keeps up
/// with the code. They neither contain nor evaluate it, so that real-time code never ends the program. The
/// switch is that of Eigen's own assertions, EIGEN_NO_DEBUG (toolchain/cmake/stilt_flags.cmake).
///
/// Data from outside, such as sensor readings, may be anything: statuses report them, not assertions.
/// Why: docs/decisions/0017-assertions-and-trace-points.md
#ifdef EIGEN_NO_DEBUG
#define STILT_ASSERT(condition) static_cast<void>(sizeof(static_cast<bool>(condition)))
#else
#define STILT_ASSERT(condition) eigen_assert(condition)
#endif
