#include "hal/can/fdcanusb/fdcanusb_bus.h"

#include <poll.h>
#include <sched.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <ctime>
#include <utility>

// Why a thread, and what settles a frame: docs/decisions/0040-fdcanusb.md
namespace stilt::hal::fdcanusb {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kReopen_ns = 200'000'000;  // between two tries
constexpr int kBitRate_bit_s = 115200;            // without meaning on USB
constexpr std::size_t kStackBytes = 256 * 1024;
constexpr auto kRelaxed = std::memory_order_relaxed;

std::int64_t now_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * kSecond_ns + time.tv_nsec;
}

timespec as_timespec(std::int64_t time_ns) noexcept { return {time_ns / kSecond_ns, time_ns % kSecond_ns}; }

}  // namespace

std::expected<void, std::string> FdcanusbBus::open(const std::string& path, const AdapterOptions& options) {
  const std::string bus = "bus " + std::string(kPrefix) + path;
  if (!path.starts_with('/')) {
    return std::unexpected(bus +
                           ": the path of a serial port follows the colon, like "
                           "fdcanusb:/dev/serial/by-id/usb-mjbots_fdcanusb_0123ABCD-if00");
  }
  path_ = path;
  options_ = options;
  auto port = serial::SerialPort::open(path, kBitRate_bit_s, serial::Access::read_write);
  if (!port) return std::unexpected(bus + ": " + port.error());
  port_.emplace(std::move(*port));
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0)
    return std::unexpected(bus + ": no socket for its thread");
  doorbell_ = socketcan::Descriptor(ends[0]);
  bell_ = socketcan::Descriptor(ends[1]);
  link_ = std::make_unique<Link>();
  frames_.emplace(*link_, doorbell_.get());
  now_ns_ = now_ns();
  session_.begin(now_ns_, 0);
  if (!start_thread()) return std::unexpected(bus + ": its thread cannot be started");
  const std::int64_t end_ns = now_ns() + options.open_timeout_ns;
  const timespec pause = as_timespec(1'000'000);
  while (!frames_->reconnect()) {
    if (now_ns() > end_ns) {
      close();
      return std::unexpected(
          bus + ": the port opens and nothing there answers `can status`; see that it is an fdcanusb");
    }
    nanosleep(&pause, nullptr);
  }
  return {};
}

bool FdcanusbBus::start_thread() {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  running_ = pthread_create(&thread_, &attributes, &FdcanusbBus::run, this) == 0;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  pthread_attr_destroy(&attributes);
  if (!running_) return false;
  pthread_setname_np(thread_, "fdcanusb");
  sched_param parameter{};
  parameter.sched_priority = options_.priority;
  // Where it is not granted, the report of the torque loop's own says so.
  if (options_.priority > 0) pthread_setschedparam(thread_, SCHED_FIFO, &parameter);
  return true;
}

void FdcanusbBus::close() noexcept {
  if (!running_) return;
  end_.store(true, kRelaxed);
  const char byte = 0;
  static_cast<void>(::send(doorbell_.get(), &byte, 1, MSG_DONTWAIT | MSG_NOSIGNAL));
  pthread_join(thread_, nullptr);
  running_ = false;
}

void* FdcanusbBus::run(void* self) {
  static_cast<FdcanusbBus*>(self)->serve();
  return nullptr;
}

void FdcanusbBus::serve() {
  while (!end_.load(kRelaxed)) {
    if (port_) {
      exchange_bytes();
    } else {
      reopen();
    }
  }
}

void FdcanusbBus::reopen() {
  pollfd bell{bell_.get(), POLLIN, 0};
  const std::int64_t until_ns = now_ns() + kReopen_ns;
  std::array<char, 64> bytes;
  for (std::int64_t now = now_ns(); now < until_ns && !end_.load(kRelaxed); now = now_ns()) {
    const timespec rest = as_timespec(until_ns - now);
    if (ppoll(&bell, 1, &rest, nullptr) > 0)
      static_cast<void>(::recv(bell_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT));
  }
  auto port = serial::SerialPort::open(path_, kBitRate_bit_s, serial::Access::read_write);
  if (!port) return;
  port_.emplace(std::move(*port));
  session_.begin(now_ns(), session_.settled());
}

void FdcanusbBus::exchange_bytes() noexcept {
  const bool hung_up = !wait();
  now_ns_ = now_ns();
  read();
  if (hung_up || session_.silent(now_ns_, options_.answer_timeout_ns)) hang_up();
  if (!port_) return;
  publish();
  take_commands();
  session_.tick(now_ns_);
  write();
}

/// Until the port has bytes, or takes more, or frames are there, or the status is due. False: the port is
/// gone.
bool FdcanusbBus::wait() noexcept {
  const bool to_write = !session_.output().empty();
  std::array<pollfd, 2> waited{
      {{port_->descriptor(), static_cast<short>(POLLIN | (to_write ? POLLOUT : 0)), 0},
       {bell_.get(), POLLIN, 0}}};
  const timespec timeout = as_timespec(kStatusPeriod_ns);
  static_cast<void>(ppoll(waited.data(), waited.size(), &timeout, nullptr));
  std::array<char, 8> byte;
  while ((waited[1].revents & POLLIN) != 0 &&
         ::recv(bell_.get(), byte.data(), byte.size(), MSG_DONTWAIT) > 0) {
  }
  return (waited[0].revents & (POLLHUP | POLLERR | POLLNVAL)) == 0;
}

void FdcanusbBus::read() noexcept {
  std::array<std::uint8_t, 2048> bytes;
  CanFrame frame;
  while (port_) {
    const std::ptrdiff_t count = port_->read(bytes);
    if (count < 0) return hang_up();
    auto rest = std::span<const std::uint8_t>(bytes).first(static_cast<std::size_t>(count));
    while (!rest.empty()) {
      rest = rest.subspan(session_.push(rest));
      while (session_.next(frame)) pass_on(frame);
    }
    if (static_cast<std::size_t>(count) < bytes.size()) return;
  }
}

bool FdcanusbBus::wanted(const CanFrame& frame) const noexcept {
  return options_.receive_ids.empty() ||
         std::any_of(options_.receive_ids.begin(), options_.receive_ids.end(),
                     [&](const FrameId& id) { return id.id == frame.id && id.extended == frame.extended; });
}

void FdcanusbBus::pass_on(const CanFrame& frame) noexcept {
  // A command that was answered before must not look unanswered where the reply is.
  link_->settled.store(session_.settled(), std::memory_order_release);
  if (wanted(frame)) static_cast<void>(link_->arrivals.push(frame));
}

/// Only into an empty output: what the port does not take must wait in the ring, where it is dropped once it
/// is old.
void FdcanusbBus::take_commands() noexcept {
  if (!session_.ready() || !session_.output().empty()) return;
  const std::uint32_t restarts = link_->restarts.load(std::memory_order_acquire);
  if (restarts != restarts_) session_.restart(now_ns_);
  restarts_ = restarts;
  while (const Command* command = link_->commands.front()) {
    if (!session_.has_room()) return;
    const bool stale = now_ns_ - command->time_ns > options_.stale_ns;
    if (stale || command->connection != connections_) {
      link_->stale.store(link_->stale.load(kRelaxed) + 1, kRelaxed);
      session_.skip(command->sequence);
    } else {
      session_.send(now_ns_, command->frame, command->sequence);
    }
    link_->commands.pop();
  }
}

void FdcanusbBus::write() noexcept {
  const auto output = session_.output();
  if (output.empty()) return;
  const std::ptrdiff_t count = port_->write(output);
  if (count < 0) return hang_up();
  session_.written(static_cast<std::size_t>(count));
}

void FdcanusbBus::publish() noexcept {
  const SessionCounts& counts = session_.counts();
  link_->taken.store(counts.taken, kRelaxed);
  link_->answers_lost.store(counts.answers_lost, kRelaxed);
  link_->error_reports.store(counts.error_reports, kRelaxed);
  link_->malformed.store(counts.malformed, kRelaxed);
  link_->health.store(session_.health(), kRelaxed);
  link_->bus_off.store(counts.bus_off, kRelaxed);
  link_->settled.store(session_.settled(), std::memory_order_release);
  if (session_.ready() && link_->connection.load(kRelaxed) == 0)
    link_->connection.store(++connections_, std::memory_order_release);
}

void FdcanusbBus::hang_up() noexcept {
  link_->connection.store(0, std::memory_order_release);
  port_.reset();
}

}  // namespace stilt::hal::fdcanusb
