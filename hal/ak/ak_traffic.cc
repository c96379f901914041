#include "hal/ak/ak_driver.h"

namespace stilt::hal::ak {
namespace {

constexpr std::uint32_t kAnyMode = 0x1f00;

IdPattern extended_id(std::uint32_t value, std::uint32_t mask = kMaximumExtendedId) {
  return {.value = value, .mask = mask, .standard = false, .extended = true};
}

}  // namespace

NodeIdentifiers identifiers(const AkDriver& driver) {
  return {{extended_id(ak_id(AkMode::force_control, driver.id)),
           extended_id(ak_id(AkMode::set_origin, driver.id))},
          {extended_id(driver.id, kMaximumExtendedId & ~kAnyMode)},
          {extended_id(ak_id(AkReport::status, driver.id)), extended_id(ak_id(AkReport::position, driver.id)),
           extended_id(ak_id(AkReport::start, driver.id))},
          {}};
}

std::vector<FrameId> receive_ids(const AkDriver& driver) {
  return {{ak_id(AkMode::force_control, driver.id), true},
          {ak_id(AkMode::set_origin, driver.id), true},
          {ak_id(AkReport::status, driver.id), true},
          {ak_id(AkReport::position, driver.id), true},
          {ak_id(AkReport::start, driver.id), true}};
}

std::vector<PeriodicFrame> periodic_frames(const AkDriver& driver, double tick_hz) {
  std::vector<PeriodicFrame> frames{{.length = 8, .extended = true, .rate_hz = tick_hz},
                                    {.length = 8, .extended = true, .rate_hz = driver.status_rate_hz}};
  if (driver.position_frames)
    frames.push_back({.length = 8, .extended = true, .rate_hz = driver.status_rate_hz});
  return frames;
}

}  // namespace stilt::hal::ak
