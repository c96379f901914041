#include "firmware/diagnostics/standard_streams.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <functional>
#include <vector>

namespace stilt::diagnostics {
namespace {

/// Whether something holds in a process of its own without these standard streams.
bool holds_without(const std::vector<int>& streams, const std::function<bool()>& claim) {
  const pid_t child = fork();
  if (child == 0) {
    for (const int stream : streams) close(stream);
    _exit(keep_standard_streams() && claim() ? EXIT_SUCCESS : EXIT_FAILURE);
  }
  int status = -1;
  return waitpid(child, &status, 0) == child && status == 0;
}

int next_number() { return open("/dev/null", O_RDWR); }

TEST(StandardStreams, NoFileOrSocketTakesTheNumberOfAClosedOne) {
  for (const std::vector<int>& closed :
       {std::vector{0}, std::vector{1}, std::vector{2}, std::vector{0, 2}, std::vector{0, 1, 2}}) {
    EXPECT_TRUE(holds_without(closed, [] { return next_number() > STDERR_FILENO; })) << closed.front();
  }
}

TEST(StandardStreams, ThatWereClosedGiveNothingAndTakeNothing) {
  EXPECT_TRUE(holds_without({0, 1, 2}, [] {
    char byte = 0;
    return read(STDIN_FILENO, &byte, 1) == -1 && errno == EBADF && write(STDOUT_FILENO, &byte, 1) == -1 &&
           errno == EBADF && write(STDERR_FILENO, &byte, 1) == -1 && errno == EBADF;
  }));
}

TEST(StandardStreams, ThatAreOpenStayAsTheyAre) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  EXPECT_TRUE(holds_without({}, [&] {
    dup2(ends[1], STDOUT_FILENO);
    return keep_standard_streams() && write(STDOUT_FILENO, "x", 1) == 1;
  }));
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 1);
  EXPECT_EQ(byte, 'x');
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
}  // namespace stilt::diagnostics
