#include "firmware/exchange/black_box.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "tests/firmware/exchange/memory_model.h"
#include "tests/firmware/exchange/weak_atomic.h"

namespace stilt::exchange {
namespace {

/// Records numbers from `first` up; a trigger at the numbers given. Returns how many were taken.
template <class Box>
int record(Box& box, int first, int count, int trigger_at = -1) {
  int taken = 0;
  for (int number = first; number < first + count; ++number) {
    int* slot = box.claim();
    if (slot == nullptr) continue;
    *slot = number;
    box.commit(number == trigger_at);
    ++taken;
  }
  return taken;
}

template <class Box>
std::vector<int> contents(const Box& box) {
  std::vector<int> numbers;
  numbers.reserve(box.size());
  for (std::size_t i = 0; i < box.size(); ++i) numbers.push_back(box.record(i));
  return numbers;
}

TEST(BlackBox, KeepsTheLastRecordsOldestFirst) {
  BlackBox<int, 4> box;
  record(box, 0, 3);
  EXPECT_EQ(contents(box), (std::vector<int>{0, 1, 2}));
  record(box, 3, 7);
  EXPECT_EQ(contents(box), (std::vector<int>{6, 7, 8, 9}));
  EXPECT_FALSE(box.frozen());
}

TEST(BlackBox, FreezesAfterTheAftermathOfTheFirstTrigger) {
  BlackBox<int, 8> box;
  box.set_aftermath(3);
  EXPECT_EQ(record(box, 0, 20, 10), 14) << "0 to 10, and three more";
  EXPECT_TRUE(box.frozen());
  EXPECT_EQ(contents(box), (std::vector<int>{6, 7, 8, 9, 10, 11, 12, 13}));
  EXPECT_EQ(box.record(box.trigger()), 10);
}

TEST(BlackBox, KnowsOfAnAftermathThatTheEndCutsShort) {
  BlackBox<int, 8> box;
  box.set_aftermath(3);
  record(box, 0, 4);
  EXPECT_FALSE(box.cut_short()) << "nothing happened";
  record(box, 4, 3, 4);
  EXPECT_TRUE(box.cut_short());
  EXPECT_EQ(box.record(box.trigger()), 4);
  record(box, 7, 1);
  EXPECT_TRUE(box.frozen());
  EXPECT_FALSE(box.cut_short()) << "it is whole";
  box.rearm();
  record(box, 8, 2);
  EXPECT_FALSE(box.cut_short()) << "nothing happened since";
}

TEST(BlackBox, AnotherTriggerBeforeTheFreezeChangesNothing) {
  BlackBox<int, 8> box;
  box.set_aftermath(3);
  record(box, 0, 3, 2);
  record(box, 3, 5, 4);
  EXPECT_EQ(contents(box).back(), 5);
}

TEST(BlackBox, WithoutAftermathTheTriggerIsTheLastRecord) {
  BlackBox<int, 4> box;
  record(box, 0, 6, 4);
  EXPECT_EQ(contents(box), (std::vector<int>{1, 2, 3, 4}));
}

TEST(BlackBox, AnAftermathNeverPushesTheTriggerOut) {
  BlackBox<int, 4> box;
  box.set_aftermath(100);
  record(box, 0, 100, 50);
  EXPECT_EQ(contents(box), (std::vector<int>{50, 51, 52, 53}));
}

TEST(BlackBox, AfterRearmingItGoesOnAfterTheRecordsThatAreThere) {
  BlackBox<int, 4> box;
  record(box, 0, 6, 4);
  box.rearm();
  EXPECT_FALSE(box.frozen());
  record(box, 20, 2);
  EXPECT_EQ(contents(box), (std::vector<int>{3, 4, 20, 21}));
  record(box, 30, 9, 32);
  EXPECT_EQ(contents(box), (std::vector<int>{21, 30, 31, 32})) << "and freezes again";
  EXPECT_EQ(box.record(box.trigger()), 32);
}

TEST(BlackBox, BetweenThreadsTheReaderSeesRecordsThatStandStill) {
  constexpr int kFreezes = 200;
  BlackBox<int, 16> box;
  std::atomic<bool> done = false;
  std::thread recorder([&] {
    for (int number = 0; !done; ++number) {
      int* slot = box.claim();
      if (slot == nullptr) {
        std::this_thread::yield();
        continue;
      }
      *slot = number;
      box.commit(number % 37 == 0);
    }
  });
  int wrong = 0;
  for (int freeze = 0; freeze < kFreezes;) {
    if (!box.frozen()) {
      std::this_thread::yield();
      continue;
    }
    const std::vector<int> numbers = contents(box);
    for (std::size_t i = 1; i < numbers.size(); ++i) wrong += numbers[i] <= numbers[i - 1] ? 1 : 0;
    wrong += numbers.empty() || numbers.back() % 37 != 0 ? 1 : 0;
    ++freeze;
    box.rearm();
  }
  done = true;
  recorder.join();
  EXPECT_EQ(wrong, 0);
}

template <template <class> class Atomic>
exchange::model::Outcome explore_box() {
  using model::ModelCell;
  std::optional<BlackBox<ModelCell, 2, Atomic>> box;
  return exchange::model::explore({.setup = [&] { box.emplace(); },
                                   .first =
                                       [&] {
                                         for (int number = 1; number <= 5; ++number) {
                                           ModelCell* slot = box->claim();
                                           if (slot == nullptr) continue;
                                           slot->write(number);
                                           box->commit(number % 2 == 0);
                                         }
                                       },
                                   .second =
                                       [&] {
                                         for (int look = 0; look < 3; ++look) {
                                           if (!box->frozen()) continue;
                                           const int last = box->record(box->size() - 1).read();
                                           if (last % 2 != 0) exchange::model::violate("not the trigger");
                                           box->rearm();
                                         }
                                       }});
}

TEST(BlackBoxModel, EveryInterleavingReadsTheFrozenRecords) {
  const exchange::model::Outcome outcome = explore_box<exchange::model::ModelAtomic>();
  EXPECT_EQ(outcome.violation, "");
  EXPECT_GT(outcome.runs, 50);
}

TEST(BlackBoxModel, WithoutAcquireOrReleaseIsCaught) {
  EXPECT_NE(explore_box<exchange::model::WithoutAcquire>().violation, "");
  EXPECT_NE(explore_box<exchange::model::WithoutRelease>().violation, "");
}

}  // namespace
}  // namespace stilt::exchange
