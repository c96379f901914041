#pragma once

#include <optional>
#include <string>

#include "firmware/program/controller_state.h"

namespace stilt::program {

/// Prints why the torso sensor does not report, as far as that can be known. Any thread but those in real
/// time.
class TorsoSensorReport {
 public:
  explicit TorsoSensorReport(const Options& options);

  /// Prints one sentence whenever it changes.
  void update(const ControllerState& state);

 private:
  std::optional<hal::canopen::Encoder> encoder_;
  std::string newest_;
};

}  // namespace stilt::program
