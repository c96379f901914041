#pragma once

#include <variant>

#include "hal/ak/ak_emulator.h"
#include "hal/mit/mit_emulator.h"
#include "hal/moteus/moteus_emulator.h"
#include "hal/odrive/odrive_emulator.h"
#include "hal/robot/joint_driver.h"

namespace stilt::hal {

/// The emulated driver of a joint, of any family.
template <class... Driver>
std::variant<decltype(make_emulator(Driver{}))...> emulator_of(const std::variant<Driver...>&);
using JointEmulator = decltype(emulator_of(JointDriver{}));

[[nodiscard]] inline JointEmulator make_emulator(const JointDriver& driver) noexcept {
  return visit_driver(driver, [](const auto& any) -> JointEmulator { return make_emulator(any); });
}

}  // namespace stilt::hal
