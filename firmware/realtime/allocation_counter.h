#pragma once

namespace stilt::realtime {

/// Counts heap allocations of the calling thread while it lives, nothing outside.
///
/// The file behind it replaces malloc, calloc, realloc, aligned_alloc, posix_memalign and memalign of the
/// program with counting ones; operator new of the standard library ends there too. Under a sanitizer, which
/// replaces the allocator itself, nothing is counted: see counts_allocations().
class AllocationScope {
 public:
  AllocationScope() noexcept;
  ~AllocationScope();
  AllocationScope(const AllocationScope&) = delete;
  AllocationScope& operator=(const AllocationScope&) = delete;

  /// Allocations since construction.
  [[nodiscard]] long long count() const noexcept;

 private:
  long long start_;
};

/// Whether this build counts.
[[nodiscard]] bool counts_allocations() noexcept;

}  // namespace stilt::realtime
