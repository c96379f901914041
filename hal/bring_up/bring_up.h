#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "hal/bring_up/setting.h"
#include "hal/can/frame.h"
#include "hal/driver/driver_fault.h"

/// From a driver that has power to one that is enabled. Identify it, check its version and scaling, write
/// its watchdog and read it back. Check that its position is valid, enable it without torque, check what
/// can only be read then. A driver takes milliseconds to enable, and its watchdog runs meanwhile. From the
/// request to enable on, every step without another frame sends a command of zero torque. The time from a
/// request after silence to its reply is that by which every reading will be late. Pure step functions:
/// time and frames in, at most one frame out. Real-time safe.
namespace stilt::hal::bring_up {

/// What is being checked or set, in this order.
enum class Stage : std::uint8_t {
  identify,
  version,
  scaling,
  watchdog_write,
  watchdog_read,
  home,
  enable,
  ready,   ///< enabled, at zero torque; each step feeds its watchdog, and one that is lost begins anew
  failed,  ///< see StepResult::failure; nothing is sent any more
};
inline constexpr std::size_t kStages = 9;
[[nodiscard]] const char* name(Stage stage) noexcept;

/// Why a bring-up ended without a driver that may be enabled.
enum class Failure : std::uint8_t {
  none,
  invalid,         ///< configuration of the driver or of the bring-up makes no sense
  silent,          ///< no answer in this stage
  rejected,        ///< answers, but does not do what it was asked in this stage
  wrong_identity,  ///< answers, but is another device
  old_version,     ///< firmware older than required
  wrong_scaling,   ///< its ranges or gains differ from the configuration
  no_watchdog,     ///< has no watchdog, and the configuration does not accept that
  wrong_watchdog,  ///< reads back another time than was written, or does not end what it should
  not_home,        ///< position not referenced, or not in exactly one turn of the joint's travel
  driver_fault,    ///< see StepResult::driver_fault
  wrong_setting,   ///< see StepResult::setting
  slow_reply,      ///< see StepResult::reply_lag_ns
  void_offsets,    ///< it was up, may have lost its power since, and its position counts from power-up
  wrong_version,   ///< another version than the configuration names, see StepResult::version
};
inline constexpr std::size_t kFailures = 15;
[[nodiscard]] const char* name(Failure failure) noexcept;

/// What the configuration asks of a driver, and how long its answers may take.
struct Options {
  double watchdog_s = 0.02;  ///< 5 to 100 ms: what the driver does without us for so long
  /// The configuration accepts a driver without a watchdog, by a key of its own.
  bool accept_missing_watchdog = false;
  std::uint32_t minimum_version = 0;  ///< moteus 0xMMmmuu, ODrive 0xMMmmrr, Damiao its number; 0: any
  double minimum_angle_rad =
      -std::numeric_limits<double>::infinity();  ///< travel of the joint at the driver's shaft
  double maximum_angle_rad = std::numeric_limits<double>::infinity();
  double maximum_speed_rad_s = 0;  ///< of the joint, at the driver's shaft
  double encoder_period_rad = 0;   ///< the absolute encoder repeats after this angle; 0: never
  std::int64_t answer_timeout_ns = 20'000'000;
  unsigned tries = 5;  ///< of each request
  /// From a request to the step that receives its reply, a step included. All replies are as old.
  std::int64_t longest_reply_lag_ns = 3'000'000;
};

/// What a step found, and the frame that it sends.
struct StepResult {
  Stage stage = Stage::identify;
  Failure failure = Failure::none;
  DriverFault driver_fault = DriverFault::none;
  std::uint32_t fault_code = 0;      ///< vendor code of driver_fault
  Setting setting = Setting::none;   ///< of the driver, when one is to blame
  std::uint32_t version = 0;         ///< of the driver, with failure wrong_version
  std::uint32_t wanted_version = 0;  ///< by the configuration, likewise
  double position_rad =
      std::numeric_limits<double>::quiet_NaN();  ///< once home is checked: at the driver's shaft
  double turn_offset_rad = 0;     ///< whole encoder periods to add to every position of the driver
  std::int64_t reply_lag_ns = 0;  ///< shortest of the first request's tries; 0: not measured yet
  bool send = false;              ///< `frame` is to be sent
  CanFrame frame;
};

/// Sequence of stages with requests, answers, repetitions and time limits. A protocol says what to ask and
/// what an answer means. Call step once per tick with the frames received since, send what it returns.
class BringUp {
 public:
  explicit BringUp(const Options& options) noexcept : options_(options) {}

  [[nodiscard]] StepResult step(std::int64_t now_ns, std::span<const CanFrame> received) noexcept;
  void restart() noexcept;
  [[nodiscard]] Stage stage() const noexcept { return stage_; }

  /// Replies to what was sent before are over then.
  static constexpr std::int64_t kRest_ns = 25'000'000;
  /// A stage that lasts longer fails, whatever is answered in it.
  static constexpr std::int64_t kLongestStage_ns = 2'000'000'000;

 protected:
  ~BringUp() = default;

  enum class Ask : std::uint8_t {
    wait_for_answer,  ///< frame filled; judge() decides about what comes back
    send_only,        ///< frame filled; nothing comes back: go on
    listen,           ///< nothing to send; asked again after kListen_ns, judge() gets what comes meanwhile
    skip,             ///< this stage has nothing to ask
    fail,             ///< failure() was called
  };
  enum class Verdict : std::uint8_t {
    ignore,      ///< not the answer
    not_yet,     ///< an answer, but not the wanted one: ask again after the timeout
    first_part,  ///< as not_yet, and the stage is to begin again
    next_part,   ///< right; the stage has more to ask
    next_stage,
    fail,  ///< failure() was called
  };

  /// Request number `part` of a stage.
  [[nodiscard]] virtual Ask ask(Stage stage, unsigned part, CanFrame& frame) noexcept = 0;
  [[nodiscard]] virtual Verdict judge(Stage stage, unsigned part, const CanFrame& frame) noexcept = 0;
  /// A command of zero torque, sent in every step when ready, and while waiting in Stage::enable. False:
  /// none.
  [[nodiscard]] virtual bool keep_alive(CanFrame& frame) noexcept = 0;

  /// A driver that is ready and has not answered for so long has lost its power or its bus.
  [[nodiscard]] virtual std::int64_t longest_silence_ns() const noexcept {
    return options_.answer_timeout_ns;
  }

  /// What a failure is to be put down to.
  struct Blame {
    DriverFault fault = DriverFault::none;
    std::uint32_t fault_code = 0;
    Setting setting = Setting::none;
    std::uint32_t version = 0;
    std::uint32_t wanted_version = 0;
  };
  /// Begins with silence, and its first request gets a reply that nothing else sends.
  [[nodiscard]] virtual Stage lag_stage() const noexcept { return Stage::identify; }

  /// Frame number `part` that takes back, before the failure, what was asked of the driver. False: no more.
  [[nodiscard]] virtual bool undo(unsigned /*part*/, CanFrame& /*frame*/) noexcept { return false; }

  void failure(Failure failure, const Blame& blame) noexcept;
  void failure(Failure what) noexcept { failure(what, Blame{}); }
  /// What the failure will be if the request that is under way never gets the right answer. It may be a fault
  /// that the driver may still clear, or a setting that may still prove right.
  void suspect(Failure failure, const Blame& blame) noexcept;
  /// Checks the driver's shaft against travel and encoder period. False after failure().
  [[nodiscard]] bool check_home(double position_rad) noexcept;
  [[nodiscard]] const Options& options() const noexcept { return options_; }
  [[nodiscard]] unsigned part() const noexcept { return part_; }
  /// Of the present request, before this one.
  [[nodiscard]] unsigned tries() const noexcept { return tries_; }
  [[nodiscard]] std::int64_t now_ns() const noexcept { return now_ns_; }
  /// Placed by check_home(), at the driver's shaft; and the whole periods that placed it.
  [[nodiscard]] double position_rad() const noexcept { return position_rad_; }
  [[nodiscard]] double turn_offset_rad() const noexcept { return turn_offset_rad_; }

  static constexpr std::int64_t kListen_ns = 50'000'000;
  static constexpr std::int64_t kLagTimeout_ns = 50'000'000;  ///< of a request after it
  static constexpr unsigned kLagProbes = 5;

 private:
  [[nodiscard]] StepResult proceed(std::int64_t now_ns, std::span<const CanFrame> received) noexcept;
  void begin_anew() noexcept;
  void rest() noexcept;
  [[nodiscard]] bool resting() noexcept;
  [[nodiscard]] bool measures_lag() const noexcept;
  [[nodiscard]] bool replies_in_time() noexcept;
  void watch(std::span<const CanFrame> received, std::int64_t since_last_step_ns) noexcept;
  void take(const CanFrame& frame) noexcept;
  void advance() noexcept;
  void give_up() noexcept;
  [[nodiscard]] StepResult result() const noexcept;
  [[nodiscard]] StepResult result_with_keep_alive(bool wanted) noexcept;

  Options options_;
  Stage stage_ = Stage::identify;
  Failure failure_ = Failure::none;
  Blame blame_;
  Failure suspected_ = Failure::none;
  Blame suspicion_;
  unsigned part_ = 0;
  unsigned tries_ = 0;
  bool waiting_ = false;
  bool answered_ = false;
  bool failing_ = false;  ///< failure() was called, and undo() may have more to send
  std::int64_t now_ns_ = 0;
  std::int64_t deadline_ns_ = 0;
  std::int64_t asked_ns_ = 0;       ///< newest try of the present request
  std::int64_t rest_until_ns_ = 0;  ///< nothing is sent, and what arrives is not looked at
  bool begins_rest_ = false;
  std::int64_t reply_lag_ns_ = 0;
  unsigned lag_probes_ = 0;
  std::int64_t silent_ns_ = 0;  ///< since the last answer of a driver that is ready
  std::int64_t stage_ns_ = 0;   ///< that the present stage has lasted
  unsigned losses_ = 0;         ///< of a driver that was ready, since restart()
  double position_rad_ = std::numeric_limits<double>::quiet_NaN();
  double turn_offset_rad_ = 0;
};

}  // namespace stilt::hal::bring_up
