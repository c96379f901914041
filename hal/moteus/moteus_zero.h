#pragma once

#include <cstddef>

#include "hal/driver/zero_progress.h"
#include "hal/moteus/moteus.h"
#include "hal/moteus/moteus_console.h"

namespace stilt::hal::moteus {

/// A stop, then commands over the command line. They make the present position zero in the configuration,
/// keep it over a power cycle, and count from it at once. Flash wears, so it is written once. Facts:
/// github.com/mjbots/moteus, docs/protocol/diagnostic.md (42d1708). Start-up only.
class MoteusZero {
 public:
  explicit MoteusZero(const MoteusDriver& driver) noexcept : driver_(driver) {}

  /// Frame to send. `lost`: the one before had no answer.
  [[nodiscard]] CanFrame next(bool lost) noexcept;
  [[nodiscard]] ZeroProgress take(const CanFrame& frame) noexcept;

 private:
  MoteusDriver driver_;
  bool stopped_ = false;
  std::size_t command_ = 0;
  ConsoleReader console_;
};

}  // namespace stilt::hal::moteus
