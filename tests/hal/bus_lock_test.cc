#include "hal/bus_lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>

namespace stilt::hal {
namespace {

std::string unique_name(const char* test) { return std::string(test) + "." + std::to_string(::getpid()); }

TEST(BusLock, OneHasItUntilItIsGivenBack) {
  const std::string name = unique_name("one");
  {
    const auto first = BusLock::take(name);
    ASSERT_TRUE(first) << first.error();
    const auto second = BusLock::take(name);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error(),
              "bus " + name + ": another stiltd, or its selftest, commands the drivers; end it first");
    EXPECT_TRUE(BusLock::take(unique_name("other")));
  }
  EXPECT_TRUE(BusLock::take(name));
}

TEST(BusLock, AProgramThatIsKilledGivesItBack) {
  const std::string name = unique_name("killed");
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const auto lock = BusLock::take(name);
    static_cast<void>(!write(ready[1], lock ? "y" : "n", 1));
    while (true) pause();
  }
  char answer = 0;
  ASSERT_EQ(read(ready[0], &answer, 1), 1);
  EXPECT_EQ(answer, 'y');
  EXPECT_FALSE(BusLock::take(name));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(BusLock::take(name));
  close(ready[0]);
  close(ready[1]);
}

TEST(BusLock, ANameThatDoesNotFitIsRefused) {
  EXPECT_EQ(BusLock::take(std::string(200, 'x')).error(),
            "bus " + std::string(200, 'x') + ": the name is too long");
}

}  // namespace
}  // namespace stilt::hal
