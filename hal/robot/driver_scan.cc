#include "hal/robot/driver_scan.h"

#include "hal/ak/ak_scan.h"
#include "hal/mit/mit_scan.h"
#include "hal/moteus/moteus_scan.h"
#include "hal/odrive/odrive_scan.h"

namespace stilt::hal {

std::vector<CanFrame> scan_frames(const JointDriver& driver) {
  return visit_driver(driver, [](const auto& any) { return scan_frames(any); });
}

bool take_scan(const JointDriver& driver, const CanFrame& frame, ScannedDriver& scanned) {
  return visit_driver(driver, [&](const auto& any) { return take_scan(any, frame, scanned); });
}

std::vector<JointDriver> scan_others(const JointDriver& driver) {
  return visit_driver(driver, [](const auto& any) {
    const auto others = scan_others(any);
    return std::vector<JointDriver>(others.begin(), others.end());
  });
}

bool sends_unasked(const JointDriver& driver) {
  return visit_driver(driver, [](const auto& any) { return sends_unasked(any); });
}

int scan_id(const JointDriver& driver) {
  return visit_driver(driver, [](const auto& any) { return scan_id(any); });
}

std::string version_text(const JointDriver& driver, std::uint32_t version) {
  return visit_driver(driver, [version](const auto& any) { return version_text(any, version); });
}

}  // namespace stilt::hal
