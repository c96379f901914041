#include "hal/ak/ak_scan.h"

#include "hal/ak/ak_driver.h"

namespace stilt::hal::ak {

bool take_scan(const AkDriver& driver, const CanFrame& frame, ScannedDriver& scanned) {
  if (take_frame(driver, frame, scanned.reading) != DecodeStatus::ok) return false;
  scanned.answered = scanned.answered || scanned.reading.has_motion;
  return true;
}

std::vector<AkDriver> scan_others(const AkDriver& driver) {
  constexpr int kIdentifiers = 256;
  std::vector<AkDriver> others;
  for (int id = 0; id < kIdentifiers; ++id) {
    if (id == driver.id) continue;
    others.push_back(driver);
    others.back().id = static_cast<std::uint8_t>(id);
  }
  return others;
}

}  // namespace stilt::hal::ak
