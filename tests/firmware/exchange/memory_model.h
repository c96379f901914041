#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <string>

/// Exhaustive check of lock-free code on a model of memory. Two threads run the code under test with
/// ModelAtomic in place of std::atomic and ModelCell as data. explore() repeats the run with every order of
/// their atomic operations and every value that each load may give.
///
/// The model follows C++: an atomic keeps all values ever stored. A load gives the newest or any older one
/// that is not overwritten before it in order. Operations of its thread make that order, and acquire loads
/// of release stores. Swaps read the newest, and pass on what the value they replace released. Data may be
/// touched only in an order of the threads. Anything else is a race, and a race is a violation, whatever
/// was read. Threads see only the past: values that depend on their own future (load buffering) are not
/// modelled.
namespace stilt::exchange::model {

inline constexpr int kThreads = 3;  ///< the two threads, and what comes before and after both
inline constexpr int kMaximumAtomics = 8;
inline constexpr int kMaximumCells = 16;

/// What a thread may observe: how far each thread had come, and the oldest value of each atomic it may still
/// see.
struct Knowledge {
  std::array<int, kThreads> steps{};
  std::array<int, kMaximumAtomics> oldest_value{};
  void join(const Knowledge& other);
};

/// What the types below call. Of no interest to tests.
[[nodiscard]] int add_atomic(long long value);
[[nodiscard]] int add_cell();
[[nodiscard]] long long load(int atomic, std::memory_order order);
void store(int atomic, long long value, std::memory_order order);
long long exchange(int atomic, long long value, std::memory_order order);
void touch(int cell, bool write);

/// The part of std::atomic that the exchange uses.
template <class T>
class ModelAtomic {
 public:
  explicit ModelAtomic(T value) : index_(add_atomic(static_cast<long long>(value))) {}
  T load(std::memory_order order) const { return static_cast<T>(model::load(index_, order)); }
  void store(T value, std::memory_order order) { model::store(index_, static_cast<long long>(value), order); }
  T exchange(T value, std::memory_order order) {
    return static_cast<T>(model::exchange(index_, static_cast<long long>(value), order));
  }

 private:
  int index_;
};

/// One number of ordinary memory.
class ModelCell {
 public:
  ModelCell() : index_(add_cell()) {}
  void write(int value) {
    touch(index_, true);
    value_ = value;
  }
  [[nodiscard]] int read() const {
    touch(index_, false);
    return value_;
  }

 private:
  int index_;
  int value_ = 0;
};

/// Reports that the algorithm did wrong. The first report of an exploration is kept.
void violate(const std::string& what);

struct Outcome {
  long runs = 0;
  std::string violation;  ///< empty: none in any run
};

/// One run: `setup` makes what the threads share, `first` and `second` are the threads, `after` looks at what
/// is left when both have ended.
struct Program {
  std::function<void()> setup;
  std::function<void()> first;
  std::function<void()> second;
  std::function<void()> after = [] {};
};

/// Runs the program in every way, or until the first violation.
[[nodiscard]] Outcome explore(const Program& program);

}  // namespace stilt::exchange::model
