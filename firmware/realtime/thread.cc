#include "firmware/realtime/thread.h"

#include <sched.h>
#include <sys/prctl.h>

#include <csignal>
#include <cstdint>

namespace stilt::realtime {
namespace {

/// What the thread sanitizer keeps for itself in each stack.
#ifdef __SANITIZE_THREAD__
constexpr std::size_t kSanitizerBytes = 2 * 1024 * 1024;
#else
constexpr std::size_t kSanitizerBytes = 0;
#endif

/// Writes to every page of the stack but the last few, which the thread's own start has touched.
[[gnu::noinline]] void touch_stack() noexcept {
  constexpr std::size_t kPage = 4096;
  volatile std::uint8_t stack[kStackBytes - 16 * kPage];
  for (std::size_t i = 0; i < sizeof stack; i += kPage) stack[i] = 0;
}

void apply(const ThreadSettings& settings) noexcept {
  pthread_setname_np(pthread_self(), settings.name);
  prctl(PR_SET_TIMERSLACK, 1UL);  // ordinary threads otherwise sleep up to 50 us longer
  if (settings.core >= 0 && settings.core < CPU_SETSIZE) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(settings.core), &set);
    pthread_setaffinity_np(pthread_self(), sizeof set, &set);
  }
  if (settings.priority > 0) {
    sched_param parameter{};
    parameter.sched_priority = settings.priority;
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
  }
}

}  // namespace

void* Thread::run(void* self) {
  auto* thread = static_cast<Thread*>(self);
  touch_stack();
  apply(thread->settings_);
  thread->work_(thread->context_);
  return nullptr;
}

bool Thread::start(const ThreadSettings& settings, void (*work)(void*), void* context) {
  settings_ = settings;
  work_ = work;
  context_ = context;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStackBytes + kSanitizerBytes);
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  running_ = pthread_create(&handle_, &attributes, &Thread::run, this) == 0;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  pthread_attr_destroy(&attributes);
  return running_;
}

void Thread::join() {
  if (running_) pthread_join(handle_, nullptr);
  running_ = false;
}

}  // namespace stilt::realtime
