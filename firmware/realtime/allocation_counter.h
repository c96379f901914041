#pragma once

namespace stilt::realtime {

/// Counts calls of the heap by the calling thread while it lives, nothing outside: blocks taken, resized and
/// given back.
///
/// The file behind it replaces malloc, calloc, realloc, aligned_alloc, posix_memalign, memalign and free of
/// the program with counting ones. Operator new and delete of the standard library end there too. Under a
/// sanitizer, which replaces the allocator itself, nothing is counted: see counts_allocations().
class AllocationScope {
 public:
  AllocationScope() noexcept;
  ~AllocationScope();
  AllocationScope(const AllocationScope&) = delete;
  AllocationScope& operator=(const AllocationScope&) = delete;

  /// Calls since construction.
  [[nodiscard]] long long count() const noexcept;

 private:
  long long start_;
};

/// From now on a heap call while the calling thread counts ends the process at once, in the very
/// instruction (SIGILL or SIGTRAP). The stack of a core dump shows who it was. For proofs, not for robots.
void end_on_heap_use() noexcept;

/// Whether this build counts.
[[nodiscard]] bool counts_allocations() noexcept;

}  // namespace stilt::realtime
