#pragma once

#include <expected>
#include <string>

#include "firmware/commissioning/dialog.h"
#include "firmware/commissioning/wiring_verdict.h"

/// The questions after a jog. Ordinary threads.
namespace stilt::commissioning {

/// A jog, what the person saw, and what both mean.
struct JogReport {
  JogRequest request;
  JogMotion motion;
  Sighting seen;
  Verdict verdict;
};

/// Moves the joint and asks what was seen; the robot stays limp meanwhile. When neither an encoder nor a link
/// has moved, the torque doubles and the joint is pushed again, up to most_torque_Nm. So a leg whose encoder
/// is dead never gets much more than its friction holds. Drivers are brought up first and off at the end.
/// @param driver  of the joint in the configuration
[[nodiscard]] std::expected<JogReport, CommandFailure> jog_and_ask(
    Session& session, const JogRequest& request, const configuration::DriverParameters& driver,
    Person& person);

[[nodiscard]] std::string to_text(const JogReport& report);
[[nodiscard]] std::string to_json(const JogReport& report);

}  // namespace stilt::commissioning
