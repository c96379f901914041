#pragma once

#include <ucontext.h>

#include <cstddef>
#include <functional>
#include <memory>

namespace stilt::exchange::model {

/// A function that can be left in the middle and continued, on a stack of its own. One kernel thread runs
/// all.
class Fiber {
 public:
  Fiber();
  ~Fiber();
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  /// Begins a function anew; the last one must have ended.
  void start(const std::function<void()>& body);
  /// Goes on until the function pauses or ends.
  void resume();
  /// Called by the function itself: back to who resumed it.
  void pause();
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  static constexpr std::size_t kStack_bytes = 256 * 1024;
  static void run(unsigned first, unsigned second);

  std::unique_ptr<char[]> stack_;
  ucontext_t context_{};
  ucontext_t caller_{};
  const std::function<void()>* body_ = nullptr;
  bool ended_ = true;
  void* thread_sanitizer_fiber_ = nullptr;
  void* thread_sanitizer_caller_ = nullptr;
};

}  // namespace stilt::exchange::model
