#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hal/bring_up/bring_up.h"
#include "hal/driver/read_setting.h"
#include "hal/mit/damiao_registers.h"
#include "hal/mit/mit_mode.h"

namespace stilt::hal::mit {

/// Reads the registers of a Damiao that bring-up requires, all of them. The others have none to ask for.
/// Start-up only.
class MitSettingReader {
 public:
  MitSettingReader(const MitDriver& driver, const bring_up::Options& options);

  /// Question to send; nothing: all are asked. `lost`: the one before had no answer, and is given up where
  /// `give_up` is set.
  [[nodiscard]] std::optional<CanFrame> next(bool lost, bool give_up);
  /// Whether it was the answer.
  [[nodiscard]] bool take(const CanFrame& frame);
  /// A frame that came unasked.
  void listen(const CanFrame& /*frame*/) {}
  [[nodiscard]] std::vector<ReadSetting> settings(double /*listened_s*/) const { return settings_; }

 private:
  MitDriver driver_;
  std::vector<ReadSetting> settings_;
  std::size_t asked_ = 0;
};

}  // namespace stilt::hal::mit
