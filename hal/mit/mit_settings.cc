#include "hal/mit/mit_settings.h"

#include <array>
#include <bit>
#include <cmath>

namespace stilt::hal::mit {
namespace {

constexpr double kTolerance = 1e-4;  // relative; the registers are floats
constexpr std::array kRegisters{DamiaoRegister::control_mode, DamiaoRegister::position_range,
                                DamiaoRegister::velocity_range, DamiaoRegister::torque_range};

double value_of(DamiaoRegister number, std::uint32_t bits) {
  return number == DamiaoRegister::control_mode ? bits : static_cast<double>(std::bit_cast<float>(bits));
}

}  // namespace

MitSettingReader::MitSettingReader(const MitDriver& driver, const bring_up::Options& /*options*/)
    : driver_(driver) {
  if (driver.layout != ReplyLayout::damiao) return;
  settings_ = {{"CTRL_MODE", "", "1"},
               {"PMAX", "", short_number(driver.position_rad.maximum)},
               {"VMAX", "", short_number(driver.velocity_rad_s.maximum)},
               {"TMAX", "", short_number(driver.torque_Nm.maximum)}};
}

std::optional<CanFrame> MitSettingReader::next(bool /*lost*/, bool give_up) {
  if (give_up) ++asked_;
  if (asked_ >= settings_.size()) return std::nullopt;
  CanFrame frame;
  const DamiaoRegisterMessage question{.number = static_cast<std::uint8_t>(kRegisters[asked_])};
  if (encode_register_request(driver_, question, frame) != EncodeStatus::ok) return std::nullopt;
  return frame;
}

bool MitSettingReader::take(const CanFrame& frame) {
  DamiaoRegisterMessage answer;
  if (asked_ >= settings_.size() || decode_register_answer(driver_, frame, answer) != DecodeStatus::ok ||
      answer.write || answer.number != static_cast<std::uint8_t>(kRegisters[asked_])) {
    return false;
  }
  const std::array wanted{1.0, driver_.position_rad.maximum, driver_.velocity_rad_s.maximum,
                          driver_.torque_Nm.maximum};
  const double value = value_of(kRegisters[asked_], answer.bits);
  ReadSetting& setting = settings_[asked_];
  setting.is = short_number(value);
  setting.right = std::abs(value - wanted[asked_]) <= kTolerance * wanted[asked_];
  ++asked_;
  return true;
}

}  // namespace stilt::hal::mit
