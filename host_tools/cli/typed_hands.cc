#include "host_tools/cli/typed_hands.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>

#include "host_tools/cli/usage_error.h"

namespace stilt::cli {
namespace {

int open_lines(const std::string& file) {
  const int descriptor = file == "-" ? STDIN_FILENO : open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  struct stat kind{};
  if (descriptor < 0 || fstat(descriptor, &kind) != 0 || S_ISDIR(kind.st_mode)) {
    if (descriptor > STDIN_FILENO) close(descriptor);
    throw UsageError("--hands " + file + ": cannot be read; name a FIFO, a file or - for standard input");
  }
  return descriptor;
}

}  // namespace

TypedHands::TypedHands(const std::string& file) : file_(file) {
  if (file.empty()) return;
  descriptor_ = open_lines(file);
  patient_ = isatty(descriptor_) == 1;
}

TypedHands::~TypedHands() {
  if (descriptor_ > STDIN_FILENO) close(descriptor_);
}

void TypedHands::read_more() {
  pollfd input{descriptor_, POLLIN, 0};
  if (poll(&input, 1, 0) <= 0) return;
  char bytes[256];
  const ssize_t count = read(descriptor_, bytes, sizeof bytes);
  if (count > 0) commands_.type({bytes, static_cast<std::size_t>(count)});
  if (count == 0) commands_.end_line();
}

void TypedHands::serve(robot_on_bus::RobotOnBus& robot) {
  if (descriptor_ < 0) return;
  read_more();
  const robot_on_bus::HandReport report = commands_.serve(robot);
  if (report.bad_line && !patient_) throw UsageError("--hands " + file_ + ": " + report.sentence);
  if (!report.sentence.empty()) std::fprintf(stderr, "\nhands: %s\n", report.sentence.c_str());
}

}  // namespace stilt::cli
