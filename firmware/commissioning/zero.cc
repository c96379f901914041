#include "firmware/commissioning/zero.h"

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "firmware/commissioning/formatted.h"
#include "firmware/commissioning/json_number.h"
#include "firmware/commissioning/json_text.h"
#include "firmware/configuration/driver_of.h"
#include "firmware/configuration/protocol_name.h"
#include "firmware/control_loop/joint_names.h"
#include "hal/robot/driver_scan.h"
#include "hal/robot/driver_zero.h"
#include "hal/robot/wiring_load.h"

namespace stilt::commissioning {
namespace {

constexpr std::int64_t kStep_ns = 1'000'000;
constexpr int kAnswerSteps = 20;
constexpr int kTries = 50;          ///< of a frame: 1 s, while a driver writes its flash it is deaf
constexpr int kMostFrames = 1'000;  ///< of a driver that answers and never ends
constexpr const char* kSilent = "does not answer";
constexpr const char* kUnread =
    "gives no answer that can be read on its command line: close tview, and set the zero again";

using configuration::DriverProtocol;

std::string lasting(DriverProtocol protocol) {
  switch (protocol) {
    case DriverProtocol::mit_damiao:
      return "the driver keeps it without power";
    case DriverProtocol::moteus:
      return "the driver keeps it without power; with an encoder of the rotor alone, within one turn of it";
    case DriverProtocol::mit_mini_cheetah:
    case DriverProtocol::mit_ak:
      break;
    case DriverProtocol::ak_v3:
      return "the driver keeps it without power; compare the angle after a power cycle, since whether its "
             "turns "
             "are kept differs by model";
    case DriverProtocol::odrive:
      return "";
  }
  return "the driver counts turns of the motor from power-up: after a power cycle the zero may be another";
}

/// What follows "does not answer": no motor is turned on for a zero.
const char* silence(DriverProtocol protocol) {
  const bool maybe_while_off =
      protocol == DriverProtocol::mit_ak || protocol == DriverProtocol::mit_mini_cheetah;
  return maybe_while_off
             ? "; where stiltd scan finds it, correct reply_id; where only stiltd watch does, its "
               "firmware is silent while the motor is off: set the zero with the vendor's tool"
             : "";
}

/// By the configuration: a scan of a driver in MIT mode takes any identifier, and so the frames of a sensor.
bool sent_by(const hal::NodeIdentifiers& driver, const hal::CanFrame& frame) {
  const hal::IdPattern sent{.value = frame.id, .standard = !frame.extended, .extended = frame.extended};
  return std::ranges::any_of(driver.sends,
                             [&sent](const hal::IdPattern& own) { return hal::overlap(own, sent); });
}

/// One joint's driver on its bus.
class Conversation {
 public:
  Conversation(hal::FrameBus& bus, hal::Clock& clock, const std::atomic<bool>& stop)
      : bus_(bus), clock_(clock), stop_(stop) {}

  /// Sends a frame and hands over what comes, until `take` is satisfied. False: it was not.
  bool ask(const hal::CanFrame& frame, const std::function<bool(const hal::CanFrame&)>& take) {
    static_cast<void>(bus_.send(std::span(&frame, 1)));  // what does not leave is not answered
    return wait(take);
  }

  /// Of what comes until `take` is satisfied. False: it was not.
  bool wait(const std::function<bool(const hal::CanFrame&)>& take) {
    for (int step = 0; step < kAnswerSteps && !stop_; ++step) {
      static_cast<void>(clock_.sleep_until(clock_.now_ns() + kStep_ns));
      if (receive(take)) return true;
    }
    return false;
  }

  /// Position of the shaft, the motor off; NaN: the driver does not answer.
  double position_rad(const hal::JointDriver& driver) {
    hal::ScannedDriver found;
    const std::vector<hal::CanFrame> questions = hal::scan_frames(driver);
    const hal::NodeIdentifiers identifiers = hal::identifiers(driver);
    const auto take = [&](const hal::CanFrame& frame) {
      return sent_by(identifiers, frame) && hal::take_scan(driver, frame, found);
    };
    for (int attempt = 0; attempt < kTries && !stop_; ++attempt) {
      for (const hal::CanFrame& question : questions) static_cast<void>(ask(question, take));
      if (questions.empty()) static_cast<void>(wait(take));
      if (std::isfinite(found.reading.position_rad)) break;
    }
    return found.reading.position_rad;
  }

 private:
  bool receive(const std::function<bool(const hal::CanFrame&)>& take) {
    std::array<hal::CanFrame, hal::kMaximumBatch> batch;
    hal::ReceiveResult received;
    bool taken = false;
    do {
      received = bus_.receive(batch);
      for (const hal::CanFrame& frame : std::span(batch).first(received.received)) {
        taken = take(frame) || taken;
      }
    } while (received.status == hal::BusStatus::more);
    return taken;
  }

  hal::FrameBus& bus_;
  hal::Clock& clock_;
  const std::atomic<bool>& stop_;
};

/// Empty: the driver has done it.
std::string store(Conversation& conversation, hal::JointZero& zero) {
  hal::ZeroProgress progress = hal::ZeroProgress::more;
  int lost = 0;
  for (int frames = 0; frames < kMostFrames && lost < kTries; ++frames) {
    const hal::CanFrame frame =
        hal::visit_driver(zero, [lost](auto& family) { return family.next(lost > 0); });
    const bool answered = conversation.ask(frame, [&](const hal::CanFrame& received) {
      if (progress == hal::ZeroProgress::done) return true;  // a late answer, after the last one
      progress = hal::visit_driver(zero, [&](auto& family) { return family.take(received); });
      return progress != hal::ZeroProgress::none;
    });
    lost = answered ? 0 : lost + 1;
    if (answered && progress == hal::ZeroProgress::done) return "";
    if (answered && progress == hal::ZeroProgress::failed) return "refuses to store a zero";
    if (answered && progress == hal::ZeroProgress::unread) return kUnread;
  }
  return kSilent;
}

}  // namespace

std::expected<ZeroReport, CommandFailure> set_zero(const configuration::HardwareParameters& hardware,
                                                   std::size_t joint, hal::FrameBus& bus, hal::Clock& clock,
                                                   const std::atomic<bool>& stop) {
  const hal::RobotWiring wiring = configuration::robot_wiring(hardware);
  const hal::JointDriver& driver = wiring.joints[joint].driver;
  const std::string name = std::string("the driver of ") + control_loop::kJointNames[joint];
  std::optional<hal::JointZero> zero = hal::make_zero(driver);
  if (!zero) {
    return std::unexpected(CommandFailure{
        name + " is an ODrive, which keeps no zero that is set over CAN: its position counts from power-up; "
               "calibrate after each power-up",
        true});
  }
  const DriverProtocol protocol = configuration::driver_of(hardware, joint).protocol;
  ZeroReport report{.joint = joint,
                    .protocol = std::string(configuration::name(protocol)),
                    .id = hal::scan_id(driver),
                    .lasts = lasting(protocol)};
  Conversation conversation(bus, clock, stop);
  report.before_rad = conversation.position_rad(driver);
  std::string trouble = std::isfinite(report.before_rad) ? "" : kSilent;
  if (trouble.empty()) trouble = store(conversation, *zero);
  if (stop) return std::unexpected(CommandFailure{"stopped", false});
  if (trouble == kSilent) trouble += silence(protocol);
  if (!trouble.empty()) return std::unexpected(CommandFailure{name + ' ' + trouble, false});
  report.after_rad = conversation.position_rad(driver);
  return report;
}

std::string to_text(const ZeroReport& report) {
  const char* joint = control_loop::kJointNames[report.joint];
  std::string text = formatted("%s (%s %d): shaft at %.4f rad before, %.4f rad after\n", joint,
                               report.protocol.c_str(), report.id, report.before_rad, report.after_rad);
  if (!report.good()) return text + "the driver has not taken it: its position must now be 0\n";
  return text + report.lasts +
         formatted("\n%s.offset_rad is now the angle of the joint in this pose; calibrate finds it\n", joint);
}

std::string to_json(const ZeroReport& report) {
  nlohmann::ordered_json json;
  json["good"] = report.good();
  json["joint"] = control_loop::kJointNames[report.joint];
  json["protocol"] = report.protocol;
  json["id"] = report.id;
  json["shaft_before_rad"] = json_number(report.before_rad);
  json["shaft_after_rad"] = json_number(report.after_rad);
  json["lasts"] = report.lasts;
  return json_text(json);
}

}  // namespace stilt::commissioning
