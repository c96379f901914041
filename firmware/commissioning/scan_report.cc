#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "firmware/commissioning/formatted.h"
#include "firmware/commissioning/json_number.h"
#include "firmware/commissioning/json_text.h"
#include "firmware/commissioning/scan.h"
#include "firmware/control_loop/joint_names.h"
#include "firmware/diagnostics/event_text.h"

namespace stilt::commissioning {
namespace {

using control_loop::kJointNames;
using Json = nlohmann::ordered_json;

std::string hexadecimal(std::uint32_t id) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%x", id);
  return text;
}

std::string measured(const char* name, double value, const char* format) {
  if (!std::isfinite(value)) return "";
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return std::string(", ") + name + text;
}

/// What an answering driver reported of itself.
std::string state_line(const ScannedNode& node) {
  const hal::DriverReading& reading = node.found.reading;
  std::string text = node.firmware.empty() ? "" : ", firmware " + node.firmware;
  text += measured("supply ", reading.supply_V, "%.1f V");
  text += measured("driver ", reading.driver_temperature_C, "%.0f C");
  text += measured("motor ", reading.motor_temperature_C, "%.0f C");
  if (reading.state != hal::DriverState::unknown) {
    text += std::string(", ") + diagnostics::state_text(reading.state);
  }
  if (reading.fault != hal::DriverFault::none) {
    text += ": " + diagnostics::fault_text(reading.fault, reading.fault_code);
  }
  if (node.found.watchdog_ended) text += ": its watchdog ended the last session";
  return text;
}

std::string settings_text(const ScannedNode& node) {
  std::string text;
  for (const hal::ReadSetting& setting : node.settings) {
    if (setting.right) continue;
    const std::string is = setting.is.empty() ? " does not read back" : " is " + setting.is;
    text += "    SETTING " + setting.name + is + ", and must be " + setting.wanted + '\n';
  }
  return text;
}

std::string errors_text(const ScannedNode& node) {
  return node.bus_errors == 0 ? ""
                              : ", " + std::to_string(node.bus_errors) + " bus errors while it was asked";
}

/// The driver answers, but not as its protocol has it.
std::string undecoded_text(const ScannedNode& node) {
  if (!node.undecoded) return "";
  return ", but sends " + std::to_string(node.undecoded->length) + " bytes under " +
         hexadecimal(node.undecoded->id) + ": look at " + control_loop::driver_section(*node.joint) +
         ".protocol";
}

std::string expected_line(const ScannedNode& node, bool stopped) {
  std::string text = "  " + std::string(kJointNames[*node.joint]) + " (" + node.protocol + " " +
                     std::to_string(node.id) + "): ";
  if (!node.found.answered && stopped) return text + "no answer before the scan was stopped\n";
  if (!node.found.answered) {
    return text + "MISSING, no answer" + undecoded_text(node) + errors_text(node) + '\n' +
           settings_text(node);
  }
  text += node.good() ? "answers" : "ANSWERS, BUT NOT WELL";
  if (node.wrong_reply_id()) {
    text += ", with identifier " + hexadecimal(*node.found.reply_id) + " where " + kJointNames[*node.joint] +
            ".reply_id is " + hexadecimal(static_cast<std::uint32_t>(*node.expected_reply_id));
  }
  if (!node.several.empty()) {
    text += ", SEVERAL drivers answer with identifier " + std::to_string(node.id) + " (" + node.several + ")";
  }
  return text + state_line(node) + '\n' + settings_text(node);
}

/// The joint that has such an identifier on another bus.
std::string meant_joint(const ScanResult& result, const ScannedBus& at, const ScannedNode& node) {
  for (const ScannedBus& bus : result.buses) {
    for (const ScannedNode& other : bus.expected) {
      const bool same = other.id == node.id && other.protocol == node.protocol;
      if (&bus == &at || !same || other.found.answered) continue;
      return "; " + std::string(kJointNames[*other.joint]) + " has this identifier on " + bus.name +
             ", where it is missing";
    }
  }
  return "";
}

std::string frames_text(const ScannedFrames& frames) {
  char rate[40];
  std::snprintf(rate, sizeof rate, ", %.0f per second", frames.rate_hz);
  return "identifier " + hexadecimal(frames.id) + (frames.extended ? " (29 bits)" : "") + rate;
}

std::string sensor_text(const ScannedFrames& frames) {
  if (frames.rate_hz == 0) return "MISSING, identifier " + hexadecimal(frames.id);
  if (frames.well()) return frames_text(frames);
  return (frames.slow() ? "LATE, " : "TOO OFTEN, ") + frames_text(frames) +
         formatted(" where torso_sensor.rate_hz is %g", frames.expected_hz);
}

/// "1 to 32, 104".
std::string ranges_text(const std::set<int>& numbers) {
  std::string text;
  for (auto next = numbers.begin(); next != numbers.end();) {
    const int first = *next;
    int last = first;
    for (++next; next != numbers.end() && *next == last + 1; ++next) last = *next;
    text += (text.empty() ? "" : ", ") + std::to_string(first);
    if (last > first) text += " to " + std::to_string(last);
  }
  return text;
}

/// Where a joint is missing: its driver may have an identifier that was not asked.
std::string asked_text(const ScannedBus& bus) {
  const bool missing =
      std::ranges::any_of(bus.expected, [](const ScannedNode& node) { return !node.found.answered; });
  if (!missing || !bus.asked_others) return "";
  return "  looked for " + bus.expected.front().protocol + " " + ranges_text(bus.asked) +
         ": a driver with another identifier is not found\n";
}

std::string bus_text(const ScanResult& result, const ScannedBus& bus) {
  std::string text = bus.name + '\n';
  if (bus.gone) {
    text += "  GONE: look at its adapter, and whether it is up\n";
  } else if (bus.off) {
    text +=
        "  OFF, after too many errors: look at its cable, termination and bit rate, then take it down and "
        "up\n";
  } else if (!bus.acknowledged) {
    text += "  NOTHING ACKNOWLEDGES frames here: look at power, cables, termination and bit rate\n";
  }
  if (bus.bus_errors > 0) {
    text +=
        "  BUS ERRORS: " + std::to_string(bus.bus_errors) +
        " while a driver was asked in vain: several of one identifier, or cables, termination or bit rate\n";
  }
  for (const ScannedNode& node : bus.expected) text += expected_line(node, result.stopped);
  for (const ScannedFrames& frames : bus.torso_sensor) {
    text += "  torso sensor: " + sensor_text(frames) + '\n';
  }
  if (!bus.torso_trouble.empty()) text += "  " + bus.torso_trouble + '\n';
  for (const ScannedNode& node : bus.unexpected) {
    text += "  UNEXPECTED: " + node.protocol + " " + std::to_string(node.id) + state_line(node) +
            meant_joint(result, bus, node) + '\n';
  }
  for (const ScannedFrames& frames : bus.unknown) text += "  UNKNOWN: " + frames_text(frames) + '\n';
  text += asked_text(bus);
  if (!result.stopped && bus.acknowledged && !bus.asked_others && !bus.expected.empty()) {
    text += "  drivers of several protocols: only those of the configuration were asked\n";
  }
  return text;
}

/// The drivers of two buses all answer on the other one.
std::string exchanged_buses(const ScanResult& result) {
  const auto all_elsewhere = [&result](const ScannedBus& bus, const ScannedBus& other) {
    return !bus.expected.empty() && std::ranges::all_of(bus.expected, [&](const ScannedNode& node) {
      return !node.found.answered && std::ranges::any_of(other.unexpected, [&node](const ScannedNode& found) {
        return found.id == node.id && found.protocol == node.protocol;
      });
    });
  };
  for (const ScannedBus& a : result.buses) {
    for (const ScannedBus& b : result.buses) {
      if (&a < &b && all_elsewhere(a, b) && all_elsewhere(b, a)) {
        return "exchanged buses: " + a.name + " and " + b.name +
               " have each other's drivers; exchange the cables, or the names in hardware.buses\n";
      }
    }
  }
  return "";
}

Json node_json(const ScannedNode& node) {
  const hal::DriverReading& reading = node.found.reading;
  Json json;
  json["joint"] = node.joint ? Json(kJointNames[*node.joint]) : Json(nullptr);
  json["protocol"] = node.protocol;
  json["id"] = node.id;
  json["answers"] = node.found.answered;
  json["reply_id"] = node.found.reply_id ? Json(*node.found.reply_id) : Json(nullptr);
  json["wrong_reply_id"] = node.wrong_reply_id();
  json["undecoded_reply"] =
      node.undecoded ? Json{{"id", node.undecoded->id}, {"length", node.undecoded->length}} : Json(nullptr);
  json["several_drivers"] = !node.several.empty();
  json["bus_errors"] = node.bus_errors;
  json["firmware"] = node.firmware.empty() ? Json(nullptr) : Json(node.firmware);
  json["supply_V"] = json_number(reading.supply_V);
  json["driver_temperature_C"] = json_number(reading.driver_temperature_C);
  json["motor_temperature_C"] = json_number(reading.motor_temperature_C);
  json["mode"] = diagnostics::state_text(reading.state);
  json["fault"] = hal::name(reading.fault);
  json["fault_code"] = reading.fault_code;
  json["watchdog_ended"] = node.found.watchdog_ended;
  if (node.joint) json["settings"] = Json::array();
  for (const hal::ReadSetting& setting : node.settings) {
    json["settings"].push_back({{"name", setting.name},
                                {"is", setting.is.empty() ? Json(nullptr) : Json(setting.is)},
                                {"wanted", setting.wanted},
                                {"right", setting.right}});
  }
  return json;
}

Json frames_json(const std::vector<ScannedFrames>& all) {
  Json json = Json::array();
  for (const ScannedFrames& frames : all) {
    json.push_back({{"id", frames.id}, {"extended", frames.extended}, {"rate_hz", frames.rate_hz}});
    if (frames.expected_hz > 0) json.back()["expected_hz"] = frames.expected_hz;
  }
  return json;
}

}  // namespace

std::string to_text(const ScanResult& result) {
  std::string text;
  for (const ScannedBus& bus : result.buses) text += bus_text(result, bus);
  text += exchanged_buses(result);
  if (!result.serial_sensor_trouble.empty()) text += result.serial_sensor_trouble + '\n';
  if (result.stopped) return text + "not complete: stopped, and not everything was asked\n";
  return text + (result.complete() ? "complete\n" : "not complete, see above\n");
}

std::string to_json(const ScanResult& result) {
  Json json;
  json["good"] = json["complete"] = result.complete();
  json["stopped"] = result.stopped;
  if (result.stopped) json["error"] = "stopped";
  json["serial_sensor_trouble"] = result.serial_sensor_trouble;
  json["buses"] = Json::array();
  for (const ScannedBus& bus : result.buses) {
    Json drivers = Json::array(), unexpected = Json::array();
    for (const ScannedNode& node : bus.expected) drivers.push_back(node_json(node));
    for (const ScannedNode& node : bus.unexpected) unexpected.push_back(node_json(node));
    json["buses"].push_back({{"name", bus.name},
                             {"gone", bus.gone},
                             {"off", bus.off},
                             {"acknowledged", bus.acknowledged},
                             {"bus_errors", bus.bus_errors},
                             {"drivers", drivers},
                             {"unexpected", unexpected},
                             {"asked_other_identifiers", bus.asked_others},
                             {"asked_identifiers", bus.asked},
                             {"torso_sensor", frames_json(bus.torso_sensor)},
                             {"torso_sensor_trouble", bus.torso_trouble},
                             {"unknown_frames", frames_json(bus.unknown)}});
  }
  return json_text(json);
}

}  // namespace stilt::commissioning
