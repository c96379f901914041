#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "hal/can/fdcanusb/line_codec.h"
#include "hal/can/frame_bus.h"

namespace stilt::hal::fdcanusb {

/// Between two questions for the status. Longer than a frame and its error frame take at 1 Mbit/s, so that a
/// frame tried again and again shows in every answer.
inline constexpr std::int64_t kStatusPeriod_ns = 2'000'000;

/// What has happened since the connection was made.
struct SessionCounts {
  std::uint64_t taken = 0;          ///< frames answered with OK
  std::uint64_t answers_lost = 0;   ///< commands that a later answer overtook
  std::uint64_t error_reports = 0;  ///< answers of ERR, and of a status in which transfers fail
  std::uint64_t malformed = 0;      ///< lines that mean nothing
  std::uint64_t bus_off = 0;
};

/// The conversation with an adapter: bytes in and out, no port and no clock. One object per connection.
///
/// When a frame has left. The adapter answers OK once a frame is in a queue: the controller's (3 frames) or
/// its own (32 more, firmware of 2025-09-14 and later). No answer says that it was on the bus, and own frames
/// do not come back. The status is asked for every kStatusPeriod_ns instead. While transfers succeed, OK
/// settles a frame. Once one has failed, OK does not. Those frames settle when a transfer succeeds, or when
/// two answers in a row report no event. Then nothing is in the controller. (Firmware from
/// 2025-09-19 removes frames without acknowledgement after 50 ms; before, it sends each frame once.) So a
/// bus without powered drivers gets the frames of a few milliseconds, and then one per identifier and round.
///
/// Real-time safe in itself: fixed memory, no call of the system.
class AdapterSession {
 public:
  /// Starts over with an adapter in any state. @param settled  goes on from there
  void begin(std::int64_t now_ns, std::uint64_t settled) noexcept;

  /// The adapter answers, and frames may be sent.
  [[nodiscard]] bool ready() const noexcept { return stage_ == Stage::ready; }

  /// Asks for the status when it is time.
  void tick(std::int64_t now_ns) noexcept;
  /// Whether send() has room for a frame.
  [[nodiscard]] bool has_room() const noexcept;
  /// Puts a frame into the output. One that cannot be carried is settled like one that is not to be sent.
  void send(std::int64_t now_ns, const CanFrame& frame, std::uint64_t sequence) noexcept;
  /// This frame is not sent.
  void skip(std::uint64_t sequence) noexcept;
  /// Takes the CAN controller off the bus and puts it back: ends bus-off.
  void restart(std::int64_t now_ns) noexcept;

  /// What is to be written to the port, and how much of it was.
  [[nodiscard]] std::span<const char> output() const noexcept;
  void written(std::size_t count) noexcept;

  /// Takes bytes that were read. @return  how many; call next() until false, then give the rest
  [[nodiscard]] std::size_t push(std::span<const std::uint8_t> bytes) noexcept;
  /// Works through what was pushed. @return  whether it came to a frame of another node
  [[nodiscard]] bool next(CanFrame& frame) noexcept;

  /// Up to this sequence no frame waits in the adapter.
  [[nodiscard]] std::uint64_t settled() const noexcept { return settled_; }
  /// Of the newest status, without bus-off: that one is counted.
  [[nodiscard]] BusHealth health() const noexcept { return health_; }
  /// A command has no answer for longer than this.
  [[nodiscard]] bool silent(std::int64_t now_ns, std::int64_t timeout_ns) const noexcept;
  [[nodiscard]] const SessionCounts& counts() const noexcept { return counts_; }

 private:
  enum class Stage : std::uint8_t {
    none,
    finding,   ///< answers to an earlier program's commands may come first
    learning,  ///< does OK follow a status?
    ready,
  };
  enum class Asked : std::uint8_t { frame, skipped, status, control };
  struct Pending {
    Asked asked = Asked::frame;
    std::uint64_t sequence = 0;
    std::int64_t time_ns = 0;
  };
  static constexpr std::size_t kMostPending = 128;
  static constexpr std::size_t kLongestLine = 512;

  void put(std::string_view text) noexcept;
  void ask(std::int64_t now_ns, Asked asked, std::uint64_t sequence, std::string_view text) noexcept;
  void ask_status(std::int64_t now_ns) noexcept;
  [[nodiscard]] const Pending& oldest() const noexcept { return pending_[first_ % kMostPending]; }
  void answered(bool taken) noexcept;
  void pass_skipped() noexcept;
  [[nodiscard]] bool take_line(CanFrame& frame) noexcept;
  void take_answer(LineKind kind) noexcept;
  void take_status(const ControllerStatus& status) noexcept;
  void meet(const ControllerStatus& status) noexcept;
  void judge(const ControllerStatus& status) noexcept;

  Stage stage_ = Stage::none;
  std::int64_t now_ns_ = 0;  ///< of the newest call that had it
  std::int64_t asked_ns_ = 0;
  bool status_pending_ = false;
  bool ok_follows_status_ = false;
  bool ok_owed_ = false;  ///< the one that follows a status

  std::array<Pending, kMostPending> pending_{};
  std::size_t first_ = 0;
  std::size_t end_ = 0;

  bool failing_ = false;        ///< a transfer failed, and none has succeeded since
  std::uint64_t answered_ = 0;  ///< up to this sequence all have answers
  std::uint64_t quiet_ = 0;     ///< as answered_ at the newest answer without an event, while failing
  std::uint64_t settled_ = 0;
  bool off_ = false;
  bool asked_before_restart_ = false;  ///< the status that is pending
  BusHealth health_ = BusHealth::active;
  SessionCounts counts_;

  std::array<char, 8192> output_{};
  std::size_t output_first_ = 0;
  std::size_t output_end_ = 0;

  std::array<char, 4096> input_{};
  std::size_t input_first_ = 0;
  std::size_t input_end_ = 0;
  std::array<char, kLongestLine> line_{};
  std::size_t line_size_ = 0;
  bool too_long_ = false;
};

}  // namespace stilt::hal::fdcanusb
