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

bool take_priority(int priority) noexcept {
  if (priority <= 0) return true;
  sched_param parameter{};
  parameter.sched_priority = priority;
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter) == 0;
}

}  // namespace

bool take_core(int core) noexcept {
  if (core < 0) return true;
  if (core >= CPU_SETSIZE) return false;
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(core), &set);
  return pthread_setaffinity_np(pthread_self(), sizeof set, &set) == 0;
}

void Thread::apply() noexcept {
  pthread_setname_np(pthread_self(), settings_.name);
  prctl(PR_SET_TIMERSLACK, 1UL);  // ordinary threads otherwise sleep up to 50 us longer
  has_core_ = take_core(settings_.core);
  has_priority_ = take_priority(settings_.priority);
  applied_.release();
}

void* Thread::run(void* self) {
  auto* thread = static_cast<Thread*>(self);
  touch_stack();
  thread->apply();
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
  if (running_) applied_.acquire();
  return running_;
}

std::string Thread::refused() const {
  std::string text;
  if (!has_priority_) text = "SCHED_FIFO priority " + std::to_string(settings_.priority);
  if (!has_core_) text += (text.empty() ? "processor " : " and processor ") + std::to_string(settings_.core);
  return text.empty() ? text : std::string("the thread of the ") + settings_.name + " did not get " + text;
}

void Thread::join() {
  if (running_) pthread_join(handle_, nullptr);
  running_ = false;
}

}  // namespace stilt::realtime
