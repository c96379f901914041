#include "host_tools/simulation/robot_on_bus/serial_line.h"

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace stilt::robot_on_bus {

SerialLine::SerialLine(const std::string& path)
    : path_(path), sensor_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  const auto refuse = [&path](const std::string& why) {
    throw std::invalid_argument("torso_sensor.serial_port " + path + ": " + why);
  };
  char name[64];
  if (!sensor_.open() || grantpt(sensor_.get()) != 0 || unlockpt(sensor_.get()) != 0 ||
      ptsname_r(sensor_.get(), name, sizeof name) != 0) {
    refuse(std::string("no pseudo-terminal can be had (") + std::strerror(errno) + ")");
  }
  port_ = hal::socketcan::Descriptor(::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (tcgetattr(port_.get(), &settings) == 0) {
    cfmakeraw(&settings);
    static_cast<void>(tcsetattr(port_.get(), TCSANOW, &settings));
  }
  if (symlink(name, path.c_str()) != 0) {
    refuse(errno == EEXIST ? "exists; the simulated sensor makes a port of that name, name one that is free"
                           : std::string("cannot be made (") + std::strerror(errno) +
                                 "); name a path in a writable folder");
  }
}

SerialLine::~SerialLine() { static_cast<void>(unlink(path_.c_str())); }

void SerialLine::write(std::span<const std::uint8_t> bytes) const noexcept {
  while (!bytes.empty()) {
    const ssize_t count = ::write(sensor_.get(), bytes.data(), bytes.size());
    if (count <= 0) return;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

}  // namespace stilt::robot_on_bus
