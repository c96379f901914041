#include "host_tools/simulation/robot_on_bus/frame_log.h"

#include <linux/can.h>

#include <cstdio>
#include <stdexcept>

namespace stilt::robot_on_bus {

std::string frame_text(const hal::CanFrame& frame) {
  char text[16];
  const bool wide = frame.extended || frame.error;
  std::snprintf(text, sizeof text, wide ? "%08X#" : "%03X#", frame.id | (frame.error ? CAN_ERR_FLAG : 0u));
  std::string result = text;
  if (frame.remote) return result + "R";
  if (frame.fd) result += frame.bit_rate_switch ? "#1" : "#0";
  for (const std::uint8_t byte : frame.payload()) {
    std::snprintf(text, sizeof text, "%02X", byte);
    result += text;
  }
  return result;
}

FrameLog::FrameLog(const std::string& file) : name_(file) {
  if (file.empty()) return;
  file_.open(file == "-" ? "/dev/stdout" : file);
  if (!file_) throw std::runtime_error("--frames " + file + ": the file cannot be written");
}

void FrameLog::write(std::uint64_t tick, std::size_t bus, Sender sender, const hal::CanFrame& frame) {
  if (name_.empty()) return;
  file_ << tick << ' ' << bus << (sender == Sender::controller ? " controller " : " robot ")
        << frame_text(frame) << '\n';
}

void FrameLog::close() {
  if (name_.empty()) return;
  file_.close();
  if (!file_)
    throw std::runtime_error("--frames " + name_ + ": not everything could be written; is the disk full?");
}

}  // namespace stilt::robot_on_bus
