#include "hal/moteus/moteus_settings.h"

#include <cmath>
#include <cstdlib>
#include <string>

#include "hal/can/bytes.h"

namespace stilt::hal::moteus {
namespace {

constexpr double kGainTolerance = 0.02;  // relative, as at bring-up
/// Places in the list.
constexpr std::size_t kKp = 0, kKi = 1, kKd = 2, kMinimum = 3, kMaximum = 4, kVelocity = 5, kTimeout = 6,
                      kBemf = 7;

double number(const ReadSetting& setting) { return std::strtod(setting.is.c_str(), nullptr); }

/// Not an error message.
bool is_number(const ReadSetting& setting) {
  char* end = nullptr;
  std::strtod(setting.is.c_str(), &end);
  return end != setting.is.c_str() && *end == '\0';
}

bool is_near(double value, double wanted) { return std::abs(value - wanted) <= kGainTolerance * wanted; }

}  // namespace

MoteusSettingReader::MoteusSettingReader(const MoteusDriver& driver, const bring_up::Options& options)
    : driver_(driver),
      travel_rev_((options.maximum_angle_rad - options.minimum_angle_rad) / kRadiansPerRevolution),
      settings_{{"servo.pid_position.kp", "", short_number(driver.kp_Nm_rev)},
                {"servo.pid_position.ki", "", "0"},
                {"servo.pid_position.kd", "", short_number(driver.kd_Nm_s_rev)},
                {"servopos.position_min", "", "nan"},
                {"servopos.position_max", "", "nan"},
                {"servo.default_velocity_limit", "", "nan"},
                {"servo.timeout_mode", "", "12"},
                {"servo.bemf_feedforward", "", "0"}} {
  console_.begin();
}

std::optional<CanFrame> MoteusSettingReader::next(bool lost, bool give_up) {
  if (give_up) {
    ++asked_;
    console_.begin();
  }
  if (asked_ >= settings_.size()) return std::nullopt;
  CanFrame frame;
  const std::string question = "conf get " + settings_[asked_].name;
  if (console_.ask(driver_, question, lost && !give_up, frame) != EncodeStatus::ok) return std::nullopt;
  return frame;
}

bool MoteusSettingReader::take(const CanFrame& frame) {
  if (asked_ >= settings_.size()) return false;
  switch (console_.take(driver_, frame)) {
    case ConsoleReader::Progress::none:
      return false;
    case ConsoleReader::Progress::more:
      break;
    case ConsoleReader::Progress::failed:
      ++asked_;
      console_.begin();
      break;
    case ConsoleReader::Progress::answer:
      settings_[asked_++].is = console_.answer();
      break;
  }
  return true;
}

/// Bounds are right where they are off, or leave as much as the travel: where that is, calibration finds.
bool MoteusSettingReader::right(std::size_t index) const {
  const double value = number(settings_[index]);
  switch (index) {
    case kKp:
      return is_near(value, driver_.kp_Nm_rev);
    case kKd:
      return is_near(value, driver_.kd_Nm_s_rev);
    case kMinimum:
    case kMaximum: {
      const double room_rev = number(settings_[kMaximum]) - number(settings_[kMinimum]);
      return std::isnan(value) || std::isnan(room_rev) || room_rev >= travel_rev_;
    }
    case kVelocity:
      return std::isnan(value);
    case kTimeout:
      return value == 12;
    case kKi:
    case kBemf:
      return value == 0;
    default:
      return false;
  }
}

std::vector<ReadSetting> MoteusSettingReader::settings(double /*listened_s*/) const {
  std::vector<ReadSetting> all = settings_;
  for (std::size_t index = 0; index < all.size(); ++index) {
    all[index].right = is_number(all[index]) && right(index);
  }
  return all;
}

}  // namespace stilt::hal::moteus
