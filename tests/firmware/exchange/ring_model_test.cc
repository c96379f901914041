#include <gtest/gtest.h>

#include <array>
#include <optional>

#include "hal/exchange/ring.h"
#include "tests/firmware/exchange/memory_model.h"
#include "tests/firmware/exchange/weak_atomic.h"

// Ring itself, and wrong variants of it, in every interleaving of a few elements.
namespace stilt::exchange {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;
constexpr auto kAcquire = std::memory_order_acquire;
constexpr auto kRelease = std::memory_order_release;
constexpr std::size_t kCapacity = 2;
constexpr int kElements = 4;
constexpr int kLooks = 3;

/// Elements 1, 2, ... go in as far as there is room; what comes out must be what went in, in order.
template <class Queue>
model::Outcome explore_ring() {
  std::optional<Queue> queue;
  std::array<int, kElements> in{};
  int given = 0;
  int taken = 0;
  const auto take = [&] {
    const model::ModelCell* element = queue->front();
    if (element == nullptr) return false;
    if (taken == kElements || element->read() != in[taken]) model::violate("not what went in");
    ++taken;
    queue->pop();
    return true;
  };
  return model::explore({.setup =
                             [&] {
                               queue.emplace();
                               in = {};
                               given = taken = 0;
                             },
                         .first =
                             [&] {
                               for (int value = 1; value <= kElements; ++value) {
                                 model::ModelCell* slot = queue->claim();
                                 if (slot == nullptr) continue;
                                 in[given] = value;
                                 slot->write(value);
                                 ++given;
                                 queue->commit();
                               }
                             },
                         .second =
                             [&] {
                               for (int look = 0; look < kLooks; ++look) take();
                             },
                         .after =
                             [&] {
                               while (taken <= kElements && take()) {
                               }
                               if (taken != given) model::violate("elements lost or doubled");
                               if (given < static_cast<int>(kCapacity))
                                 model::violate("dropped with room left");
                             }});
}

template <class Queue>
void expect_caught() {
  EXPECT_NE(explore_ring<Queue>().violation, "");
}

TEST(RingModel, EveryInterleavingKeepsElementsWholeInOrderAndOnce) {
  const model::Outcome outcome = explore_ring<Ring<model::ModelCell, kCapacity, model::ModelAtomic>>();
  EXPECT_EQ(outcome.violation, "");
  EXPECT_GT(outcome.runs, 1000);
  RecordProperty("runs", std::to_string(outcome.runs));
}

TEST(RingModel, WithoutAcquireIsCaught) {
  expect_caught<Ring<model::ModelCell, kCapacity, model::WithoutAcquire>>();
}

TEST(RingModel, WithoutReleaseIsCaught) {
  expect_caught<Ring<model::ModelCell, kCapacity, model::WithoutRelease>>();
}

/// Wrong in one place, by choice.
enum class Mistake { none, index_before_element, one_element_too_many, handed_back_before_read, stale_room };

template <Mistake kMistake>
class WrongRing {
 public:
  model::ModelCell* claim() {
    constexpr int kRoom = kMistake == Mistake::one_element_too_many ? 3 : 2;
    constexpr auto kOrder = kMistake == Mistake::stale_room ? kRelaxed : kAcquire;
    const int written = written_.load(kRelaxed);
    if (written - read_.load(kOrder) == kRoom) return nullptr;
    if (kMistake == Mistake::index_before_element) written_.store(written + 1, kRelease);
    return &elements_[written % 2];
  }
  void commit() {
    if (kMistake != Mistake::index_before_element) written_.store(written_.load(kRelaxed) + 1, kRelease);
  }
  const model::ModelCell* front() {
    const int read = read_.load(kRelaxed);
    if (written_.load(kAcquire) == read) return nullptr;
    if (kMistake == Mistake::handed_back_before_read) read_.store(read + 1, kRelease);
    return &elements_[read % 2];
  }
  void pop() {
    if (kMistake != Mistake::handed_back_before_read) read_.store(read_.load(kRelaxed) + 1, kRelease);
  }

 private:
  std::array<model::ModelCell, 2> elements_;
  model::ModelAtomic<int> written_{0};
  model::ModelAtomic<int> read_{0};
};

TEST(RingModel, TheVariantWithoutMistakeIsCorrect) {
  EXPECT_EQ(explore_ring<WrongRing<Mistake::none>>().violation, "");
}

TEST(RingModel, AdvancingTheIndexBeforeWritingTheElementIsCaught) {
  expect_caught<WrongRing<Mistake::index_before_element>>();
}

TEST(RingModel, OneElementTooManyIsCaught) { expect_caught<WrongRing<Mistake::one_element_too_many>>(); }

TEST(RingModel, HandingASlotBackBeforeReadingItIsCaught) {
  expect_caught<WrongRing<Mistake::handed_back_before_read>>();
}

TEST(RingModel, LookingForRoomWithoutAcquireIsCaught) { expect_caught<WrongRing<Mistake::stale_room>>(); }

}  // namespace
}  // namespace stilt::exchange
