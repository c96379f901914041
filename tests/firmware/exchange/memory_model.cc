#include "tests/firmware/exchange/memory_model.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "tests/firmware/exchange/fiber.h"

namespace stilt::exchange::model {
namespace {

constexpr int kOutside = 2;  // before and after both threads

bool acquires(std::memory_order order) {
  return order != std::memory_order_relaxed && order != std::memory_order_release;
}
bool releases(std::memory_order order) {
  return order != std::memory_order_relaxed && order != std::memory_order_acquire;
}

/// A value an atomic once had, and what reading it with acquire makes known.
struct Message {
  long long value;
  Knowledge known;
};

/// When a cell was last touched: 0 is before everything.
struct Touches {
  int writer = kOutside;
  int write_step = 0;
  std::array<int, kThreads> read_step{};
};

/// Walks through all sequences of choices, depth first.
class Choices {
 public:
  void rewind() { next_ = 0; }
  void clear() { taken_.clear(); }
  int choose(int count) {
    if (next_ == taken_.size()) taken_.push_back({0, count});
    return taken_[next_++].taken;
  }
  /// Moves on to the next sequence; false when there is none.
  bool advance() {
    while (!taken_.empty() && taken_.back().taken + 1 == taken_.back().count) taken_.pop_back();
    if (taken_.empty()) return false;
    ++taken_.back().taken;
    return true;
  }

 private:
  struct Choice {
    int taken;
    int count;
  };
  std::vector<Choice> taken_;
  std::size_t next_ = 0;
};

/// Which of the two threads ever stored into an atomic, in any run so far.
struct Writers {
  std::array<bool, 2> known{};
};

struct World {
  Choices choices;
  std::vector<std::vector<Message>> atomics;
  std::vector<Touches> cells;
  std::array<Knowledge, kThreads> knowledge;
  std::array<Fiber, 2> fibers;
  std::array<Writers, kMaximumAtomics> writers;
  bool learned = false;  ///< writers changed in this run
  int current = kOutside;
  std::string violation;

  Knowledge& own() { return knowledge[current]; }
  /// Another thread may go first: before every atomic operation, and nowhere else. Races on data are found
  /// from the order of the threads, not from what is read.
  void let_others_run() {
    if (current != kOutside) fibers[current].pause();
  }
  /// Loading what no other thread writes comes to the same before and after any step of the other thread.
  [[nodiscard]] bool order_matters(int atomic) const {
    return writers[atomic].known[1 - current] || !writers[atomic].known[current];
  }
  void note_writer(int atomic) {
    if (current == kOutside || writers[atomic].known[current]) return;
    writers[atomic].known[current] = true;
    learned = true;
  }
  void begin() {
    learned = false;
    choices.rewind();
    atomics.clear();
    cells.clear();
    knowledge = {};
    current = kOutside;
  }
};

World* world = nullptr;

void run_threads(const Program& program) {
  world->knowledge[0] = world->knowledge[1] = world->knowledge[kOutside];
  world->fibers[0].start(program.first);
  world->fibers[1].start(program.second);
  for (;;) {
    std::array<int, 2> ready{};
    int count = 0;
    for (int thread = 0; thread < 2; ++thread) {
      if (!world->fibers[thread].ended()) ready[count++] = thread;
    }
    if (count == 0) break;
    world->current = ready[count == 1 ? 0 : world->choices.choose(count)];
    world->fibers[world->current].resume();
  }
  world->current = kOutside;
  world->own().join(world->knowledge[0]);
  world->own().join(world->knowledge[1]);
}

}  // namespace

void Knowledge::join(const Knowledge& other) {
  for (int i = 0; i < kThreads; ++i) steps[i] = std::max(steps[i], other.steps[i]);
  for (int i = 0; i < kMaximumAtomics; ++i)
    oldest_value[i] = std::max(oldest_value[i], other.oldest_value[i]);
}

int add_atomic(long long value) {
  if (world->atomics.size() == kMaximumAtomics) throw std::length_error("too many atomics for the model");
  world->atomics.push_back({{value, {}}});
  return static_cast<int>(world->atomics.size()) - 1;
}

int add_cell() {
  if (world->cells.size() == kMaximumCells) throw std::length_error("too many cells for the model");
  world->cells.emplace_back();
  return static_cast<int>(world->cells.size()) - 1;
}

long long load(int atomic, std::memory_order order) {
  if (world->current != kOutside && world->order_matters(atomic)) world->let_others_run();
  ++world->own().steps[world->current];
  const std::vector<Message>& messages = world->atomics[atomic];
  const int newest = static_cast<int>(messages.size()) - 1;
  const int oldest = world->own().oldest_value[atomic];
  const int read = newest - (newest == oldest ? 0 : world->choices.choose(newest - oldest + 1));
  world->own().oldest_value[atomic] = read;
  if (acquires(order)) world->own().join(messages[read].known);
  return messages[read].value;
}

void store(int atomic, long long value, std::memory_order order) {
  world->let_others_run();
  ++world->own().steps[world->current];
  world->note_writer(atomic);
  std::vector<Message>& messages = world->atomics[atomic];
  world->own().oldest_value[atomic] = static_cast<int>(messages.size());
  messages.push_back({value, releases(order) ? world->own() : Knowledge{}});
}

long long exchange(int atomic, long long value, std::memory_order order) {
  world->let_others_run();
  ++world->own().steps[world->current];
  world->note_writer(atomic);
  std::vector<Message>& messages = world->atomics[atomic];
  const Message replaced = messages.back();
  if (acquires(order)) world->own().join(replaced.known);
  world->own().oldest_value[atomic] = static_cast<int>(messages.size());
  Message message{value, releases(order) ? world->own() : Knowledge{}};
  message.known.join(replaced.known);
  messages.push_back(message);
  return replaced.value;
}

void touch(int cell, bool write) {
  Knowledge& own = world->own();
  Touches& touches = world->cells[cell];
  ++own.steps[world->current];
  bool ordered = touches.write_step <= own.steps[touches.writer];
  if (write) {
    for (int thread = 0; thread < kThreads; ++thread) {
      ordered = ordered && touches.read_step[thread] <= own.steps[thread];
    }
    touches.writer = world->current;
    touches.write_step = own.steps[world->current];
  } else {
    touches.read_step[world->current] = own.steps[world->current];
  }
  if (!ordered) violate(write ? "a write races with another thread" : "a read races with another thread");
}

void violate(const std::string& what) {
  if (world->violation.empty()) world->violation = what;
}

Outcome explore(const Program& program) {
  World of_this_call;
  world = &of_this_call;
  Outcome outcome;
  bool more = true;
  while (more) {
    world->begin();
    program.setup();
    run_threads(program);
    program.after();
    ++outcome.runs;
    if (world->learned) {
      world->choices.clear();  // other steps to choose between: from the start
      outcome.runs = 0;
    } else {
      more = world->choices.advance();
    }
    more = more && world->violation.empty();
  }
  outcome.violation = world->violation;
  world = nullptr;
  return outcome;
}

}  // namespace stilt::exchange::model
