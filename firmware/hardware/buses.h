#pragma once

#include <cstdint>

namespace stilt::hardware {

/// What the torque loop needs of the buses beside joints and sensors. No call waits, allocates, locks or
/// throws.
class Buses {
 public:
  /// Frames lost, withheld or malformed and reports of errors, on all buses since the start.
  [[nodiscard]] virtual std::uint64_t errors() const noexcept = 0;

  /// The operator wants a new start: forgets bus-off, and has lost connections made again, later and
  /// elsewhere. Call it every tick until that is over.
  virtual void restore() noexcept = 0;

 protected:
  ~Buses() = default;
};

}  // namespace stilt::hardware
