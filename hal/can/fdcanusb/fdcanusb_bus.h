#pragma once

#include <pthread.h>

#include <atomic>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/can/fdcanusb/adapter_session.h"
#include "hal/can/fdcanusb/link.h"
#include "hal/can/fdcanusb/link_frames.h"
#include "hal/can/socketcan/descriptor.h"
#include "hal/serial/serial_port.h"

namespace stilt::hal::fdcanusb {

/// Filters, priority and time limits of an adapter.
struct AdapterOptions {
  std::vector<FrameId> receive_ids{};            ///< identifiers to receive; empty: everything
  int priority = 0;                              ///< SCHED_FIFO of the port's thread; 0: ordinary
  std::int64_t stale_ns = 2'000'000;             ///< frames that waited longer for the port are dropped
  std::int64_t answer_timeout_ns = 500'000'000;  ///< an adapter without answers for so long is gone
  std::int64_t open_timeout_ns = 2'000'000'000;  ///< for the first answers, at open()
};

/// An fdcanusb at a serial port. A thread of its own reads and writes the port: the kernel's terminals take
/// locks, and a torque loop must not wait for them. Opens the port again by itself after it was gone.
class FdcanusbBus {
 public:
  FdcanusbBus() = default;
  FdcanusbBus(const FdcanusbBus&) = delete;
  FdcanusbBus& operator=(const FdcanusbBus&) = delete;
  ~FdcanusbBus() { close(); }

  /// Opens the port and waits for the adapter's answers. Once per object. The error is one sentence for the
  /// user.
  /// @param path  of the serial port
  [[nodiscard]] std::expected<void, std::string> open(const std::string& path, const AdapterOptions& options);

  /// After BusStatus::disconnected: call until true. Never waits, allocates nothing.
  [[nodiscard]] bool reconnect() noexcept { return frames_->reconnect(); }

  /// Valid after open().
  [[nodiscard]] LinkFrames& frames() noexcept { return *frames_; }

 private:
  static void* run(void* self);
  [[nodiscard]] bool start_thread();
  void close() noexcept;
  void serve();
  void reopen();
  void exchange_bytes() noexcept;
  [[nodiscard]] bool wait() noexcept;
  void read() noexcept;
  void take_commands() noexcept;
  void write() noexcept;
  void pass_on(const CanFrame& frame) noexcept;
  [[nodiscard]] bool wanted(const CanFrame& frame) const noexcept;
  void publish() noexcept;
  void hang_up() noexcept;

  std::string path_;
  AdapterOptions options_;
  std::unique_ptr<Link> link_;
  std::optional<LinkFrames> frames_;
  socketcan::Descriptor doorbell_;  ///< the end that is signalled
  socketcan::Descriptor bell_;      ///< the end that wakes the thread

  // The thread's.
  std::optional<serial::SerialPort> port_;
  AdapterSession session_;
  std::uint32_t connections_ = 0;
  std::uint32_t restarts_ = 0;
  std::int64_t now_ns_ = 0;

  std::atomic<bool> end_{false};
  pthread_t thread_{};
  bool running_ = false;
};

}  // namespace stilt::hal::fdcanusb
