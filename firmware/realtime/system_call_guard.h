#pragma once

namespace stilt::realtime {

/// From now on this thread may use the few system calls of a real-time thread. Any other ends the process at
/// once with SIGSYS, and does not come back. Allowed: sleeping, clocks, moving frames, its own usage
/// counters, and what ending a thread takes. Everything that can wait for another thread (futex), take memory
/// (mmap, brk) or touch a file is not. For proofs, not for robots: a program that ends leaves the joints to
/// the drivers' watchdogs.
///
/// A seccomp filter of this thread only; it cannot be taken off again.
///
/// @return false when the kernel has no seccomp filters, or runs another instruction set than we know
[[nodiscard]] bool forbid_other_system_calls() noexcept;

}  // namespace stilt::realtime
