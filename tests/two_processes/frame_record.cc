#include "tests/two_processes/frame_record.h"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <variant>

namespace stilt::two_processes {
namespace {

using hal::DecodeStatus;
using hal::mit::MitDriver;

hal::CanFrame parse_frame(const std::string& text) {
  const std::size_t hash = text.find('#');
  if (hash == std::string::npos) throw std::runtime_error("no frame: " + text);
  hal::CanFrame frame;
  frame.id = static_cast<std::uint32_t>(std::stoul(text.substr(0, hash), nullptr, 16));
  frame.error = (frame.id & 0x20000000u) != 0;
  frame.extended = hash > 3 && !frame.error;
  frame.id &= hal::kMaximumExtendedId;
  for (std::size_t at = hash + 1; at + 1 < text.size(); at += 2) {
    frame.data[frame.length++] = static_cast<std::uint8_t>(std::stoul(text.substr(at, 2), nullptr, 16));
  }
  return frame;
}

void take(const RecordedFrame& recorded, std::size_t joint, const MitDriver& driver, MotorTraffic& traffic) {
  hal::mit::MitCommand command;
  hal::mit::MitSpecial special{};
  hal::mit::MitReply reply;
  if (recorded.from_controller) {
    if (decode_special(driver, recorded.frame, special) == DecodeStatus::ok) {
      traffic.specials.push_back({recorded.tick, joint, special});
    } else if (decode_command(driver, recorded.frame, command) == DecodeStatus::ok) {
      traffic.commands.push_back({recorded.tick, joint, command});
    }
  } else if (decode_reply(driver, recorded.frame, reply) == DecodeStatus::ok) {
    traffic.replies.push_back({recorded.tick, joint, reply});
  }
}

}  // namespace

std::vector<RecordedFrame> read_frames(const std::string& file) {
  std::vector<RecordedFrame> frames;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    RecordedFrame recorded;
    std::string sender, text;
    if (!(words >> recorded.tick >> recorded.bus >> sender >> text)) {
      throw std::runtime_error("no line of a frame log: " + line);
    }
    recorded.from_controller = sender == "controller";
    recorded.frame = parse_frame(text);
    frames.push_back(recorded);
  }
  return frames;
}

MotorTraffic motor_traffic(const std::vector<RecordedFrame>& frames, const hal::RobotWiring& wiring) {
  MotorTraffic traffic;
  for (const RecordedFrame& recorded : frames) {
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      if (wiring.joints[joint].bus != recorded.bus) continue;
      take(recorded, joint, std::get<MitDriver>(wiring.joints[joint].driver), traffic);
    }
  }
  return traffic;
}

}  // namespace stilt::two_processes
