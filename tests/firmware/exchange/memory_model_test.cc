#include "tests/firmware/exchange/memory_model.h"

#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <utility>

// Litmus tests: the model allows what C++ allows, and nothing else.
namespace stilt::exchange::model {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;
constexpr auto kAcquire = std::memory_order_acquire;
constexpr auto kRelease = std::memory_order_release;

struct Flagged {
  ModelCell data;
  ModelAtomic<int> flag{0};
};

Outcome message_passing(std::memory_order store_order, std::memory_order load_order) {
  std::optional<Flagged> shared;
  return explore({.setup = [&] { shared.emplace(); },
                  .first =
                      [&] {
                        shared->data.write(7);
                        shared->flag.store(1, store_order);
                      },
                  .second =
                      [&] {
                        if (shared->flag.load(load_order) == 0) return;
                        if (shared->data.read() != 7) violate("the flag came without the data");
                      }});
}

TEST(MemoryModel, DataBehindAReleasedAndAcquiredFlagIsSeen) {
  EXPECT_EQ(message_passing(kRelease, kAcquire).violation, "");
}

TEST(MemoryModel, DataBehindARelaxedFlagIsARace) {
  EXPECT_NE(message_passing(kRelaxed, kAcquire).violation, "");
  EXPECT_NE(message_passing(kRelease, kRelaxed).violation, "");
}

TEST(MemoryModel, BothThreadsMayMissTheOthersStore) {
  struct Two {
    ModelAtomic<int> x{0};
    ModelAtomic<int> y{0};
  };
  std::optional<Two> shared;
  std::pair<int, int> seen;
  std::set<std::pair<int, int>> outcomes;
  const Outcome outcome = explore({.setup = [&] { shared.emplace(); },
                                   .first =
                                       [&] {
                                         shared->x.store(1, kRelease);
                                         seen.first = shared->y.load(kAcquire);
                                       },
                                   .second =
                                       [&] {
                                         shared->y.store(1, kRelease);
                                         seen.second = shared->x.load(kAcquire);
                                       },
                                   .after = [&] { outcomes.insert(seen); }});
  EXPECT_EQ(outcome.violation, "");
  EXPECT_EQ(outcomes, (std::set<std::pair<int, int>>{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
}

TEST(MemoryModel, AnAtomicNeverGoesBackForAThread) {
  std::optional<ModelAtomic<int>> shared;
  std::set<std::pair<int, int>> outcomes;
  const Outcome outcome = explore({.setup = [&] { shared.emplace(0); },
                                   .first =
                                       [&] {
                                         shared->store(1, kRelaxed);
                                         shared->store(2, kRelaxed);
                                       },
                                   .second =
                                       [&] {
                                         const int earlier = shared->load(kRelaxed);
                                         const int later = shared->load(kRelaxed);
                                         if (later < earlier) violate("it went back");
                                         outcomes.insert({earlier, later});
                                       }});
  EXPECT_EQ(outcome.violation, "");
  EXPECT_EQ(outcomes.size(), 6u) << "0 0, 0 1, 0 2, 1 1, 1 2, 2 2";
}

TEST(MemoryModel, EverythingIsKnownWhenBothThreadsHaveEnded) {
  std::optional<Flagged> shared;
  const Outcome outcome = explore({.setup = [&] { shared.emplace(); },
                                   .first = [&] { shared->data.write(3); },
                                   .second = [&] { shared->flag.store(1, kRelaxed); },
                                   .after =
                                       [&] {
                                         if (shared->data.read() != 3 || shared->flag.load(kRelaxed) != 1)
                                           violate("not known");
                                       }});
  EXPECT_EQ(outcome.violation, "");
}

}  // namespace
}  // namespace stilt::exchange::model
