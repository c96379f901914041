#include "hal/serial/serial_port.h"

#include <fcntl.h>
#include <linux/serial.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

namespace stilt::hal::serial {
namespace {

constexpr std::array<int, 8> kRates{9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600};
constexpr std::array<speed_t, kRates.size()> kSpeeds{B9600,   B19200,  B38400,  B57600,
                                                     B115200, B230400, B460800, B921600};

/// False: errno says why.
bool set_up(int descriptor, speed_t speed) noexcept {
  termios settings{};
  if (tcgetattr(descriptor, &settings) != 0) return false;
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  return cfsetspeed(&settings, speed) == 0 && tcsetattr(descriptor, TCSANOW, &settings) == 0 &&
         tcflush(descriptor, TCIFLUSH) == 0;
}

/// An FTDI adapter collects bytes for 16 ms otherwise. Other ports have no such setting.
void ask_for_low_latency(int descriptor) noexcept {
  serial_struct settings{};
  if (ioctl(descriptor, TIOCGSERIAL, &settings) != 0) return;
  settings.flags |= ASYNC_LOW_LATENCY;
  static_cast<void>(ioctl(descriptor, TIOCSSERIAL, &settings));
}

std::string not_opened(const std::string& path, int error, Access access) {
  std::string text = "serial port " + path + ": cannot be opened (" + std::strerror(error) + ")";
  if (error == ENOENT) {
    text += access == Access::read ? "; see torso_sensor.serial_port, ls /dev/ttyUSB* /dev/ttyACM* /dev/ttyS*"
                                   : "; ls /dev/serial/by-id names those there are";
  }
  if (error == EACCES) text += "; add the user to its group, as in usermod -aG dialout USER";
  if (error == EBUSY || error == EWOULDBLOCK) text += "; another program has it";
  return text;
}

}  // namespace

std::span<const int> bit_rates() noexcept { return kRates; }

std::expected<SerialPort, std::string> SerialPort::open(const std::string& path, int bit_rate_bit_s,
                                                        Access access) {
  const auto found = std::find(kRates.begin(), kRates.end(), bit_rate_bit_s);
  if (found == kRates.end())
    return std::unexpected("serial port " + path + ": no port has " + std::to_string(bit_rate_bit_s) +
                           " bit/s");
  const int mode = access == Access::read ? O_RDONLY : O_RDWR;
  SerialPort port(::open(path.c_str(), mode | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port.descriptor_.open()) return std::unexpected(not_opened(path, errno, access));
  const int descriptor = port.descriptor_.get();
  if (access == Access::read_write && flock(descriptor, LOCK_EX | LOCK_NB) != 0)
    return std::unexpected(not_opened(path, errno, access));
  if (!set_up(descriptor, kSpeeds[static_cast<std::size_t>(found - kRates.begin())])) {
    return std::unexpected("serial port " + path + ": cannot be set up (" + std::strerror(errno) +
                           "); is it a serial port?");
  }
  static_cast<void>(ioctl(descriptor, TIOCEXCL));  // a second program is refused
  ask_for_low_latency(descriptor);
  port.writes_ = access == Access::read_write;
  return port;
}

/// The kernel's close() waits for up to 30 s until all bytes have left (closing_wait of tty_port.c).
SerialPort::~SerialPort() {
  constexpr int kSteps = 20;
  constexpr timespec kStep{0, 1'000'000};
  if (!descriptor_.open() || !writes_) return;
  int waiting = 0;
  for (int step = 0; step < kSteps; ++step) {
    if (ioctl(descriptor_.get(), TIOCOUTQ, &waiting) != 0 || waiting == 0) return;
    nanosleep(&kStep, nullptr);
  }
  static_cast<void>(tcflush(descriptor_.get(), TCOFLUSH));
}

bool SerialPort::wait(std::int64_t timeout_ns) const noexcept {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  pollfd waited{descriptor_.get(), POLLIN, 0};
  const timespec timeout{timeout_ns / kSecond_ns, timeout_ns % kSecond_ns};
  return ppoll(&waited, 1, &timeout, nullptr) > 0;
}

std::ptrdiff_t SerialPort::read(std::span<std::uint8_t> bytes) const noexcept {
  const ssize_t count = ::read(descriptor_.get(), bytes.data(), bytes.size());
  if (count >= 0) return count;
  return errno == EAGAIN || errno == EINTR ? 0 : -1;
}

std::ptrdiff_t SerialPort::write(std::span<const char> bytes) const noexcept {
  const ssize_t count = ::write(descriptor_.get(), bytes.data(), bytes.size());
  if (count >= 0) return count;
  return errno == EAGAIN || errno == EINTR ? 0 : -1;
}

}  // namespace stilt::hal::serial
