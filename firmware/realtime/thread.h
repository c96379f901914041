#pragma once

#include <pthread.h>

#include <cstddef>
#include <semaphore>
#include <string>

namespace stilt::realtime {

/// Stack of a real-time thread, touched before its work begins.
inline constexpr std::size_t kStackBytes = 512 * 1024;

/// Name, priority and core of a thread.
struct ThreadSettings {
  const char* name = "";  ///< at most 15 characters
  int priority = 0;       ///< SCHED_FIFO; 0: ordinary
  int core = -1;          ///< -1: any
};

/// Puts the calling thread on this processor alone; below 0 on any, which changes nothing. False: the kernel
/// does not grant it.
[[nodiscard]] bool take_core(int core) noexcept;

/// A thread with scheduling of its own, a stack that is in memory from the start, and no signals.
/// Construction and join are for start-up and exit.
class Thread {
 public:
  /// Starts work(context) on a new thread. Priority or processor that cannot be had are left out, see
  /// refused(); false only when there is no thread at all.
  [[nodiscard]] bool start(const ThreadSettings& settings, void (*work)(void*), void* context);
  void join();

  /// What the thread asked for and did not get, one sentence; empty: it has all. After start().
  [[nodiscard]] std::string refused() const;

  Thread() = default;
  Thread(const Thread&) = delete;
  Thread& operator=(const Thread&) = delete;
  ~Thread() { join(); }

 private:
  static void* run(void* self);
  void apply() noexcept;

  ThreadSettings settings_;
  void (*work_)(void*) = nullptr;
  void* context_ = nullptr;
  pthread_t handle_{};
  bool running_ = false;
  bool has_priority_ = false;
  bool has_core_ = false;
  std::binary_semaphore applied_{0};  ///< the two above are known
};

}  // namespace stilt::realtime
