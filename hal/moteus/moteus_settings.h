#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hal/bring_up/bring_up.h"
#include "hal/driver/read_setting.h"
#include "hal/moteus/moteus.h"
#include "hal/moteus/moteus_console.h"

namespace stilt::hal::moteus {

/// Reads all settings of docs/deployment.md over the command line of a moteus. Start-up only.
class MoteusSettingReader {
 public:
  /// @param options  travel of the joint at the driver's shaft
  MoteusSettingReader(const MoteusDriver& driver, const bring_up::Options& options);

  /// As of mit::MitSettingReader; a question takes several frames.
  [[nodiscard]] std::optional<CanFrame> next(bool lost, bool give_up);
  [[nodiscard]] bool take(const CanFrame& frame);
  void listen(const CanFrame& /*frame*/) {}
  [[nodiscard]] std::vector<ReadSetting> settings(double listened_s) const;

 private:
  [[nodiscard]] bool right(std::size_t index) const;

  MoteusDriver driver_;
  double travel_rev_;
  std::vector<ReadSetting> settings_;
  std::size_t asked_ = 0;
  ConsoleReader console_;
};

}  // namespace stilt::hal::moteus
