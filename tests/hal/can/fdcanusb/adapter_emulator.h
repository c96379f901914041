#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "hal/can/frame.h"
#include "tests/own_folder.h"
#include "tests/pseudo_terminal.h"

namespace stilt::hal::fdcanusb {

/// A line for a frame from the bus, without its end, as the adapter's firmware writes it.
[[nodiscard]] std::string received_line(const CanFrame& frame);

/// An fdcanusb at a pseudo-terminal. Behaves as the vendor's firmware does
/// (https://github.com/mjbots/fdcanusb, commit f18c1d6a0c572768eeb9c6a05d01707f1964bfd3, fw/can_manager.cc):
/// answers, the queues of 3 and 32 frames, and registers of its controller. Time is left out: a test sets
/// when frames without acknowledgement are cancelled.
class AdapterEmulator {
 public:
  AdapterEmulator() { plug_in(); }

  /// The same name after each plug_in().
  [[nodiscard]] std::string path() const { return folder_.file("adapter"); }
  /// Powers up, and appears.
  void plug_in();
  void unplug() { terminal_.reset(); }

  /// Takes what was written and answers; waits at most this long for it.
  void serve(int timeout_ms = 1);
  /// A node of the bus sends a frame.
  void deliver(const CanFrame& frame) { write(received_line(frame) + "\r\n"); }
  void write(const std::string& text) const;

  /// The three frames of the controller are given up, as 50 ms without progress do it.
  void cancel();
  /// The controller goes off the bus.
  void fall_off() { off_ = true; }

  /// Frames that were on the bus.
  [[nodiscard]] std::vector<CanFrame> on_bus() const { return on_bus_; }
  /// Every line it was given.
  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }
  /// Frames in its queues.
  [[nodiscard]] std::size_t queued() const { return controller_.size() + queue_.size(); }

  bool acknowledged = true;           ///< another node is powered
  bool deaf = false;                  ///< takes lines and does nothing
  bool refuses_frames = false;        ///< answers ERR to each frame
  bool statuses_end_with_ok = false;  ///< as the README says; the firmware does not

 private:
  [[nodiscard]] std::string answer(const std::string& line);
  [[nodiscard]] std::string answer_frame(const std::string& line);
  [[nodiscard]] std::string status();
  void transmit();

  tests::OwnFolder folder_;
  std::unique_ptr<tests::PseudoTerminal> terminal_;
  std::string input_;
  std::vector<std::string> lines_;
  std::vector<CanFrame> on_bus_;
  std::deque<CanFrame> controller_;
  std::deque<CanFrame> queue_;
  bool on_ = true;
  bool off_ = false;
  unsigned last_error_ = 7;
  unsigned error_count_ = 0;
};

}  // namespace stilt::hal::fdcanusb
