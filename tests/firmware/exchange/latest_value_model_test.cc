#include <gtest/gtest.h>

#include <array>
#include <optional>

#include "firmware/exchange/latest_value.h"
#include "tests/firmware/exchange/memory_model.h"
#include "tests/firmware/exchange/weak_atomic.h"

// LatestValue itself, and wrong variants of it, in every interleaving of a few publications and reads.
namespace stilt::exchange {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;
constexpr auto kAcquire = std::memory_order_acquire;
constexpr auto kRelease = std::memory_order_release;
constexpr auto kBoth = std::memory_order_acq_rel;
constexpr int kPublications = 4;
constexpr int kReads = 4;

/// Two numbers that belong together.
struct Pair {
  model::ModelCell first;
  model::ModelCell second;
};

int whole(const Pair& pair) {
  const int first = pair.first.read();
  if (pair.second.read() != first) model::violate("halves of two values");
  return first;
}

template <class Slot>
model::Outcome explore_slot() {
  std::optional<Slot> slot;
  int last = 0;
  const auto read = [&] {
    const int value = whole(slot->newest());
    if (value < last) model::violate("an older value after a newer one");
    last = value;
  };
  return model::explore({.setup =
                             [&] {
                               slot.emplace();
                               last = 0;
                             },
                         .first =
                             [&] {
                               for (int value = 1; value <= kPublications; ++value) {
                                 slot->writer().first.write(value);
                                 slot->writer().second.write(value);
                                 slot->publish();
                               }
                             },
                         .second =
                             [&] {
                               for (int i = 0; i < kReads; ++i) read();
                             },
                         .after =
                             [&] {
                               read();
                               if (last != kPublications) model::violate("the last value was lost");
                             }});
}

template <class Slot>
void expect_caught() {
  EXPECT_NE(explore_slot<Slot>().violation, "");
}

TEST(LatestValueModel, EveryInterleavingGivesWholeValuesInOrderAndTheLastOne) {
  const model::Outcome outcome = explore_slot<LatestValue<Pair, model::ModelAtomic>>();
  EXPECT_EQ(outcome.violation, "");
  EXPECT_GT(outcome.runs, 1000);
  RecordProperty("runs", std::to_string(outcome.runs));
}

TEST(LatestValueModel, WithoutAcquireIsCaught) { expect_caught<LatestValue<Pair, model::WithoutAcquire>>(); }

TEST(LatestValueModel, WithoutReleaseIsCaught) { expect_caught<LatestValue<Pair, model::WithoutRelease>>(); }

/// Two slots: the writer comes back to the one that is being read.
class DoubleBuffer {
 public:
  Pair& writer() { return slots_[1 - published_]; }
  void publish() {
    published_ = 1 - published_;
    newest_.store(published_, kRelease);
  }
  const Pair& newest() { return slots_[newest_.load(kAcquire)]; }

 private:
  std::array<Pair, 2> slots_;
  model::ModelAtomic<int> newest_{0};
  int published_ = 0;
};

TEST(LatestValueModel, TwoSlotsInsteadOfThreeAreCaught) { expect_caught<DoubleBuffer>(); }

/// Three slots in turn, without the reader's say: twice around and the writer is where the reader is.
class ThreeInTurn {
 public:
  Pair& writer() { return slots_[writing_]; }
  void publish() {
    newest_.store(writing_, kRelease);
    writing_ = (writing_ + 1) % 3;
  }
  const Pair& newest() { return slots_[newest_.load(kAcquire)]; }

 private:
  std::array<Pair, 3> slots_;
  model::ModelAtomic<int> newest_{2};
  int writing_ = 0;
};

TEST(LatestValueModel, SlotsInTurnWithoutHandingBackAreCaught) { expect_caught<ThreeInTurn>(); }

/// The swaps of LatestValue with chosen orders, and a choice to swap without news.
template <std::memory_order kPublish, std::memory_order kTake, bool kOnlyNews>
class Swapping {
 public:
  Pair& writer() { return slots_[writing_]; }
  void publish() { writing_ = middle_.exchange(writing_ | 4, kPublish) & 3; }
  const Pair& newest() {
    if (!kOnlyNews || (middle_.load(kRelaxed) & 4) != 0) reading_ = middle_.exchange(reading_, kTake) & 3;
    return slots_[reading_];
  }

 private:
  std::array<Pair, 3> slots_;
  model::ModelAtomic<int> middle_{1};
  int writing_ = 0;
  int reading_ = 2;
};

TEST(LatestValueModel, SwappingWithChosenOrdersIsCorrectWithTheRightOnes) {
  EXPECT_EQ((explore_slot<Swapping<kBoth, kBoth, true>>().violation), "");
}

TEST(LatestValueModel, EachOfTheFourOrdersIsNeeded) {
  expect_caught<Swapping<kAcquire, kBoth, true>>();
  expect_caught<Swapping<kRelease, kBoth, true>>();
  expect_caught<Swapping<kBoth, kAcquire, true>>();
  expect_caught<Swapping<kBoth, kRelease, true>>();
}

TEST(LatestValueModel, TakingTheMiddleWithoutNewsIsCaught) { expect_caught<Swapping<kBoth, kBoth, false>>(); }

/// Fills the slot after handing it over.
class PublishBeforeWrite {
 public:
  Pair& writer() {
    if (published_) return *given_;
    given_ = &slot_.writer();
    slot_.publish();
    published_ = true;
    return *given_;
  }
  void publish() { published_ = false; }
  const Pair& newest() { return slot_.newest(); }

 private:
  LatestValue<Pair, model::ModelAtomic> slot_;
  Pair* given_ = nullptr;
  bool published_ = false;
};

TEST(LatestValueModel, PublishingBeforeWritingIsCaught) { expect_caught<PublishBeforeWrite>(); }

}  // namespace
}  // namespace stilt::exchange
