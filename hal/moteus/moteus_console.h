#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/moteus/moteus.h"

/// The command line of a moteus, which its frames carry beside the registers: "conf get NAME" gives a setting
/// that no register shows. Facts: github.com/mjbots/moteus, docs/protocol/diagnostic.md; github.com/
/// mjbots/mjlib, mjlib/multiplex/micro_server.cc, mjlib/micro/persistent_config.cc (48bcba0). Real-time safe.
namespace stilt::hal::moteus {

/// Some bytes of the command line, at most those of a frame.
class ConsoleText {
 public:
  void append(std::string_view text) noexcept {
    for (const char each : text) {
      if (size_ < characters_.size()) characters_[size_++] = each;
    }
  }
  void clear() noexcept { size_ = 0; }
  [[nodiscard]] std::string_view view() const noexcept { return {characters_.data(), size_}; }

 private:
  std::array<char, kMaximumFrameBytes> characters_{};
  std::size_t size_ = 0;
};

/// Text for the driver's command line; the reply carries what it has written so far.
[[nodiscard]] EncodeStatus encode_console(const MoteusDriver& driver, std::string_view text,
                                          CanFrame& frame) noexcept;
/// Asks for what it has written, to be sent until there is nothing more.
[[nodiscard]] EncodeStatus encode_console_poll(const MoteusDriver& driver, CanFrame& frame) noexcept;
/// What it has written; none: the frame holds nothing of it.
[[nodiscard]] std::optional<ConsoleText> decode_console(const MoteusDriver& driver,
                                                        const CanFrame& frame) noexcept;

// The driver's side: for emulated drivers and tests.

/// Text of a frame to the driver, empty for a poll; none: the frame is not for the command line.
[[nodiscard]] std::optional<ConsoleText> decode_console_request(const MoteusDriver& driver,
                                                                const CanFrame& frame) noexcept;
[[nodiscard]] EncodeStatus encode_console_answer(const MoteusDriver& driver, const CanFrame& request,
                                                 std::string_view text, CanFrame& answer) noexcept;

/// Gives a driver one command after the other, each with a line as its answer, a frame and its reply at a
/// time. Telemetry is stopped first, and what is left unread is read away: an answer does not name its
/// question. A reply that is lost may be that of a command that was taken: then it only waits for the answer.
class ConsoleReader {
 public:
  /// A command that gets no answer.
  enum class Given : std::uint8_t {
    again,  ///< is given again, a few times
    once,   ///< has failed
  };
  enum class Progress : std::uint8_t {
    none,    ///< the frame was not of the command line
    more,    ///< send the next frame
    answer,  ///< see answer()
    failed,  ///< no answer that can be read, or text without end
  };

  /// Begins with the first command, after all that is left over has been read.
  void begin() noexcept;
  /// Next frame to send, for a command such as "conf get servo.timeout_mode". It may be given twice.
  /// @param lost  the last one got no reply
  [[nodiscard]] EncodeStatus ask(const MoteusDriver& driver, std::string_view command, bool lost,
                                 CanFrame& frame, Given given = Given::again) noexcept;
  [[nodiscard]] Progress take(const MoteusDriver& driver, const CanFrame& frame) noexcept;
  /// The line that came, without its end.
  [[nodiscard]] std::string_view answer() const noexcept;

 private:
  enum class Step : std::uint8_t { stop, drain, ask, read };

  void start_over() noexcept;
  void lose_reply() noexcept;

  Step step_ = Step::stop;
  Given given_ = Given::again;  ///< the present command
  unsigned quiet_ = 0;          ///< replies in a row without text
  unsigned replies_ = 0;        ///< since the last answer
  ConsoleText line_;
};

}  // namespace stilt::hal::moteus
