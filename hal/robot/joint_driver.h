#pragma once

#include <variant>

#include "hal/ak/ak_driver.h"
#include "hal/driver/visit.h"
#include "hal/mit/mit_driver.h"
#include "hal/moteus/moteus_driver.h"
#include "hal/odrive/odrive_driver.h"

namespace stilt::hal {

/// The driver of a joint, of any family. The functions that each has are listed in hal/README.md.
using JointDriver = std::variant<mit::MitDriver, moteus::MoteusDriver, odrive::OdriveDriver, ak::AkDriver>;

/// What brings any of them up.
template <class... Driver>
std::variant<decltype(make_bring_up(Driver{}, bring_up::Options{}))...> bring_up_of(
    const std::variant<Driver...>&);
using JointBringUp = decltype(bring_up_of(JointDriver{}));

}  // namespace stilt::hal
