#include "firmware/realtime/allocation_counter.h"

#include <atomic>
#include <cerrno>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
#define STILT_COUNT_ALLOCATIONS 0
#else
#define STILT_COUNT_ALLOCATIONS 1
#endif

namespace {
thread_local int open_scopes = 0;
thread_local long long allocations = 0;
std::atomic<bool> ends_process = false;
}  // namespace

#if STILT_COUNT_ALLOCATIONS

namespace {
void count_one() noexcept {
  if (open_scopes == 0) return;
  ++allocations;
  if (ends_process.load(std::memory_order_relaxed)) __builtin_trap();
}
}  // namespace

extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier): glibc's names for its own functions
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
// NOLINTEND(bugprone-reserved-identifier)

void* malloc(std::size_t bytes) noexcept {
  count_one();
  return __libc_malloc(bytes);
}

void free(void* block) noexcept {
  if (block != nullptr) count_one();
  __libc_free(block);
}

void* calloc(std::size_t items, std::size_t bytes) noexcept {
  count_one();
  return __libc_calloc(items, bytes);
}

void* realloc(void* block, std::size_t bytes) noexcept {
  count_one();
  return __libc_realloc(block, bytes);
}

void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
  count_one();
  return __libc_memalign(alignment, bytes);
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
  count_one();
  return __libc_memalign(alignment, bytes);
}

int posix_memalign(void** result, std::size_t alignment, std::size_t bytes) noexcept {
  if (alignment < sizeof(void*) || (alignment & (alignment - 1)) != 0) return EINVAL;
  count_one();
  void* block = __libc_memalign(alignment, bytes);
  if (block == nullptr) return ENOMEM;
  *result = block;
  return 0;
}
}  // extern "C"

#endif

namespace stilt::realtime {

AllocationScope::AllocationScope() noexcept : start_(allocations) { ++open_scopes; }

AllocationScope::~AllocationScope() { --open_scopes; }

long long AllocationScope::count() const noexcept { return allocations - start_; }

void end_on_heap_use() noexcept { ends_process.store(true); }

bool counts_allocations() noexcept { return STILT_COUNT_ALLOCATIONS != 0; }

}  // namespace stilt::realtime
