#include "tests/hal/can/fdcanusb/adapter_emulator.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <span>
#include <sstream>

namespace stilt::hal::fdcanusb {
namespace {

std::string hex(std::uint32_t value, int digits) {
  char text[16];
  std::snprintf(text, sizeof text, "%0*X", digits, value);
  return text;
}

constexpr unsigned kPassive = 128;
constexpr unsigned kWarning = 96;
constexpr std::size_t kMailboxes = 3;
constexpr std::size_t kQueue = 32;

}  // namespace

std::string received_line(const CanFrame& frame) {
  const int digits = frame.id > 0xffffff ? 8 : frame.id > 0xffff ? 6 : frame.id > 0xff ? 4 : 2;
  std::string line = "rcv " + hex(frame.id, digits) + " ";
  for (const std::uint8_t byte : frame.payload()) line += hex(byte, 2);
  line += frame.extended ? " E" : " e";
  line += frame.bit_rate_switch ? " B" : " b";
  line += frame.fd ? " F" : " f";
  line += frame.remote ? " R" : " r";
  return line + " x00";
}

void AdapterEmulator::plug_in() {
  terminal_ = std::make_unique<tests::PseudoTerminal>();
  std::filesystem::remove(path());
  std::filesystem::create_symlink(terminal_->port(), path());
  input_.clear();
  controller_.clear();
  queue_.clear();
  on_ = true;
  off_ = false;
  last_error_ = 7;
  error_count_ = 0;
}

void AdapterEmulator::write(const std::string& text) const {
  if (!terminal_) return;
  terminal_->write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void AdapterEmulator::serve(int timeout_ms) {
  if (!terminal_) return;
  input_ += terminal_->read(timeout_ms);
  for (std::size_t end = input_.find_first_of("\r\n"); end != std::string::npos;
       end = input_.find_first_of("\r\n")) {
    const std::string line = input_.substr(0, end);
    input_.erase(0, end + 1);
    if (line.empty()) continue;
    lines_.push_back(line);
    if (!deaf) write(answer(line) + "\r\n");
    transmit();
  }
}

std::string AdapterEmulator::answer(const std::string& line) {
  if (line == "can on") {
    if (on_) return "ERR already in BusOn";
    on_ = true;
    off_ = false;
    error_count_ = 0;
    last_error_ = 7;
    return "OK";
  }
  if (line == "can off") {
    if (!on_) return "ERR already in BusOff";
    on_ = false;
    controller_.clear();  // its own queue keeps what it has
    return "OK";
  }
  if (line == "can status") return status();
  if (line.starts_with("can send ") || line.starts_with("can std ") || line.starts_with("can ext "))
    return answer_frame(line);
  return line.starts_with("can ") ? "ERR unknown subcommand" : "ERR unknown command";
}

std::string AdapterEmulator::status() {
  if (!on_) return "ERR not in BusOn";
  std::string line =
      "lec=" + std::to_string(last_error_) + " dlec=7 err=" + (error_count_ >= kPassive ? "1" : "0") +
      " warn=" + (error_count_ >= kWarning ? "1" : "0") + " busoff=" + (off_ ? "1" : "0") + " pexc=0 tdc=19";
  last_error_ = 7;
  return statuses_end_with_ok ? line + "\r\nOK" : line;
}

std::string AdapterEmulator::answer_frame(const std::string& line) {
  if (!on_) return "ERR not in BusOn state";
  if (refuses_frames) return "ERR unknown flag";
  std::istringstream words(line);
  std::string can, kind, id, data, flags;
  words >> can >> kind >> id >> data >> flags;
  if (data.empty()) return "ERR insufficient options";
  CanFrame frame;
  frame.id = static_cast<std::uint32_t>(std::stoul(id, nullptr, 16));
  frame.extended = kind == "ext" || (kind == "send" && frame.id > kMaximumStandardId);
  frame.bit_rate_switch = frame.fd = true;  // as configured by the vendor
  for (const char flag : flags) {
    if (flag == 'B' || flag == 'b') frame.bit_rate_switch = flag == 'B';
    if (flag == 'F' || flag == 'f') frame.fd = flag == 'F';
    if (flag == 'R' || flag == 'r') frame.remote = flag == 'R';
  }
  for (std::size_t i = 0; i + 1 < data.size(); i += 2)
    frame.data[i / 2] = static_cast<std::uint8_t>(std::stoul(data.substr(i, 2), nullptr, 16));
  frame.length = fd_length(data.size() / 2);
  if (queue_.empty() && controller_.size() < kMailboxes) {
    controller_.push_back(frame);
  } else if (queue_.size() < kQueue) {
    queue_.push_back(frame);
  }
  return "OK";
}

void AdapterEmulator::transmit() {
  while (on_ && !off_ && acknowledged && !controller_.empty()) {
    on_bus_.push_back(controller_.front());
    controller_.pop_front();
    last_error_ = 0;
    error_count_ -= std::min(error_count_, 1u);
    if (!queue_.empty()) {
      controller_.push_back(queue_.front());
      queue_.pop_front();
    }
  }
  if (on_ && !acknowledged && !controller_.empty()) {
    last_error_ = 3;
    error_count_ = std::min(error_count_ + 8 * 8, kPassive);
  }
}

void AdapterEmulator::cancel() {
  controller_.clear();
  while (!queue_.empty() && controller_.size() < kMailboxes) {
    controller_.push_back(queue_.front());
    queue_.pop_front();
  }
}

}  // namespace stilt::hal::fdcanusb
