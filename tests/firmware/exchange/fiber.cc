#include "tests/firmware/exchange/fiber.h"

#include <array>
#include <bit>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace stilt::exchange::model {
namespace {

using Halves = std::array<unsigned, 2>;  // of a pointer

}  // namespace

Fiber::Fiber() : stack_(std::make_unique<char[]>(kStack_bytes)) {
#ifdef __SANITIZE_THREAD__
  thread_sanitizer_fiber_ = __tsan_create_fiber(0);  // it needs every change of stack
#endif
  ::getcontext(&context_);
  context_.uc_stack.ss_sp = stack_.get();
  context_.uc_stack.ss_size = kStack_bytes;
  const auto halves = std::bit_cast<Halves>(this);  // makecontext passes numbers of the size of int only
  ::makecontext(&context_, reinterpret_cast<void (*)()>(&Fiber::run), 2, halves[0], halves[1]);
}

Fiber::~Fiber() {
#ifdef __SANITIZE_THREAD__
  __tsan_destroy_fiber(thread_sanitizer_fiber_);
#endif
}

void Fiber::start(const std::function<void()>& body) {
  body_ = &body;
  ended_ = false;
}

void Fiber::run(unsigned first, unsigned second) {
  auto* fiber = std::bit_cast<Fiber*>(Halves{first, second});
  for (;;) {  // one function after the other, so that the stack never has to be set up again
    (*fiber->body_)();
    fiber->ended_ = true;
    fiber->pause();
  }
}

void Fiber::resume() {
#ifdef __SANITIZE_THREAD__
  thread_sanitizer_caller_ = __tsan_get_current_fiber();
  __tsan_switch_to_fiber(thread_sanitizer_fiber_, 0);
#endif
  ::swapcontext(&caller_, &context_);
}

void Fiber::pause() {
#ifdef __SANITIZE_THREAD__
  __tsan_switch_to_fiber(thread_sanitizer_caller_, 0);
#endif
  ::swapcontext(&context_, &caller_);
}

}  // namespace stilt::exchange::model
