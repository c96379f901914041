#pragma once

#include <stilt/types.h>

#include <cstdint>
#include <expected>
#include <memory>
#include <string>

namespace stilt {

/// Planner, estimator, torque law and supervisor of stiltd, in a loop of the user's own (docs/library.md):
///
///   each tick:        measurements -> tick() -> targets for the drivers
///   beside or after:  plan(), which the next tick uses
///
/// tick() and plan() may run on two threads, one each; request() on a third. None of the three allocates,
/// locks, waits or throws. The order of calls decides everything: no clock is read.
class Controller {
 public:
  /// Takes milliseconds. The error is one sentence: what is wrong, where, what would be right.
  [[nodiscard]] static std::expected<Controller, std::string> create(const Settings& settings);

  Controller(Controller&&) noexcept;
  Controller& operator=(Controller&&) noexcept;
  ~Controller();

  /// Period of the torque loop and time between two plans, of the configuration.
  [[nodiscard]] std::int64_t tick_period_ns() const noexcept;
  [[nodiscard]] std::int64_t plan_period_ns() const noexcept;

  /// Before the first tick, for a robot that stands already, in a simulation: no bring-up, no standing up.
  /// Makes the first plan, which takes milliseconds. Without it a controller begins in the state boot, and
  /// stands up when it is asked to.
  void begin_standing(std::int64_t now_ns, const Measurements& measurements) noexcept;

  /// What the robot shall do from now on. A later request replaces it. One thread.
  /// @param speed_m_s  of walk; cut to telemetry.speed_limit_m_s either way, and NaN is 0
  void request(Motion motion, double speed_m_s = 0.0) noexcept;

  /// One tick: estimates the state, decides, computes torques. The reference stays valid until the next call.
  /// @param now_ns  of a steady clock, above 0
  [[nodiscard]] const Tick& tick(std::int64_t now_ns, const Measurements& measurements) noexcept;

  /// One plan from the state of the newest tick, for later ticks. Does nothing while the robot is not on its
  /// feet, or when no tick came since the last call.
  /// @return  whether there is a new plan
  bool plan() noexcept;

 private:
  struct Parts;
  explicit Controller(std::unique_ptr<Parts> parts) noexcept;
  std::unique_ptr<Parts> parts_;
};

}  // namespace stilt
