#include "hal/robot/driver_zero.h"

namespace stilt::hal {

std::optional<JointZero> make_zero(const JointDriver& driver) {
  if (const auto* mit = std::get_if<mit::MitDriver>(&driver)) return mit::MitZero(*mit);
  if (const auto* moteus = std::get_if<moteus::MoteusDriver>(&driver)) return moteus::MoteusZero(*moteus);
  if (const auto* ak = std::get_if<ak::AkDriver>(&driver)) return ak::AkZero(*ak);
  return std::nullopt;
}

}  // namespace stilt::hal
