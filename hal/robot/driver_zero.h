#pragma once

#include <optional>
#include <variant>

#include "hal/ak/ak_zero.h"
#include "hal/mit/mit_zero.h"
#include "hal/moteus/moteus_zero.h"
#include "hal/robot/joint_driver.h"

/// Makes the present position of a driver its zero. Start-up only.
namespace stilt::hal {

using JointZero = std::variant<mit::MitZero, moteus::MoteusZero, ak::AkZero>;

/// Nothing for an ODrive: over CAN it takes a position that is lost without power.
[[nodiscard]] std::optional<JointZero> make_zero(const JointDriver& driver);

}  // namespace stilt::hal
