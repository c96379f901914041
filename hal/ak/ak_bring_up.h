#pragma once

#include <algorithm>
#include <cstdint>

#include "hal/ak/ak_protocol.h"
#include "hal/bring_up/bring_up.h"

namespace stilt::hal::ak {

/// AK of version 3. It is on from power-up, answers nothing and holds its last command, so that limp commands
/// go first and all the time. The rest is listening: a status, its position, how often it reports, and no
/// fault. It has neither a version nor a watchdog to read, and is refused unless
/// Options::accept_missing_watchdog. How a fault ends is not public: it has a second for that.
class AkBringUp final : public bring_up::BringUp {
 public:
  AkBringUp(const AkDriver& driver, const bring_up::Options& options) noexcept
      : BringUp(options), driver_(driver) {}

 private:
  [[nodiscard]] Ask ask(bring_up::Stage stage, unsigned part, CanFrame& frame) noexcept override;
  [[nodiscard]] Verdict judge(bring_up::Stage stage, unsigned part, const CanFrame& frame) noexcept override;
  [[nodiscard]] bool keep_alive(CanFrame& frame) noexcept override {
    return encode_limp(driver_, frame) == EncodeStatus::ok;
  }
  /// None: nothing that it sends is a reply.
  [[nodiscard]] bring_up::Stage lag_stage() const noexcept override { return bring_up::Stage::failed; }
  /// Ten reports at least.
  [[nodiscard]] std::int64_t longest_silence_ns() const noexcept override {
    return std::max(options().answer_timeout_ns, static_cast<std::int64_t>(1e10 / driver_.status_rate_hz));
  }

  [[nodiscard]] Ask limp(CanFrame& frame) noexcept;
  [[nodiscard]] Ask await_frames(bring_up::Failure otherwise) noexcept;
  [[nodiscard]] Ask ask_rates() noexcept;
  [[nodiscard]] Verdict judge_home(unsigned part, const CanFrame& frame) noexcept;
  [[nodiscard]] Verdict judge_enable(const CanFrame& frame) noexcept;
  [[nodiscard]] unsigned least_reports() const noexcept;

  AkDriver driver_;
  unsigned listened_ = 0;   ///< times, for the present part
  unsigned statuses_ = 0;   ///< while listening for their rate
  unsigned positions_ = 0;  ///< and position frames that agree with the status before them
  double status_rad_ = 0;   ///< newest, while listening
  bool received_ = false;   ///< something, while it is enabled
  Blame fault_;             ///< newest
};

}  // namespace stilt::hal::ak
