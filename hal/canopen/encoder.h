#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "hal/can/bus_load.h"
#include "hal/can/codec_status.h"
#include "hal/can/frame.h"
#include "hal/can/identifiers.h"
#include "hal/canopen/canopen.h"

/// An absolute encoder on CANopen. Sources: CiA 406, "Device profile for encoders", 3.2 (objects 0x6000 to
/// 0x65ff); CiA 301, 4.2.0 (0x1000, 0x1017, 0x1800, 0x1A00).
namespace stilt::hal::canopen {

/// One encoder, as it is set up.
struct Encoder {
  std::uint8_t node = 32;
  std::uint32_t steps_per_turn = 65536;
  std::uint32_t turns = 1;  ///< after which its position repeats
  double speed_rad_s = 0;   ///< of its shaft, a unit of object 0x6030; 0: that is not read
};

/// Node 1 to 127, at least 2 steps, at least a turn, a position of at most 32 bits, a finite speed.
[[nodiscard]] bool valid(const Encoder& encoder) noexcept;

namespace objects {
inline constexpr Object kDeviceType{0x1000, 0};
inline constexpr Object kHeartbeatTime{0x1017, 0};  ///< ms, 16 bits
inline constexpr Object kPdoIdentifier{0x1800, 1};
inline constexpr Object kPdoTransmission{0x1800, 2};  ///< 1: with every SYNC
inline constexpr Object kPdoEntries{0x1a00, 0};
inline constexpr Object kPdoFirst{0x1a00, 1};
inline constexpr Object kPdoSecond{0x1a00, 2};
inline constexpr Object kScaledSteps{0x6001, 0};
inline constexpr Object kScaledRange{0x6002, 0};
inline constexpr Object kPosition{0x6004, 0};
inline constexpr Object kSpeed{0x6030, 1};
inline constexpr Object kOperatingStatus{0x6500, 0};  ///< bit 2: kScaledSteps and kScaledRange are active
inline constexpr Object kSteps{0x6501, 0};
inline constexpr Object kTurns{0x6502, 0};  ///< 16 bits
}  // namespace objects

inline constexpr std::uint32_t kEncoderProfile = 406;  ///< low 16 bits of the device type
inline constexpr std::uint32_t kScalingOn = 4;
/// Entries of a mapping: index, subindex, bits.
inline constexpr std::uint32_t kPositionEntry = 0x60040020;
inline constexpr std::uint32_t kSpeedEntry = 0x60300110;

/// Why an encoder does not report.
enum class EncoderFailure : std::uint8_t {
  none,
  silent,      ///< no answer to the object, or with index 0: no position
  aborted,     ///< it refused the object, with the abort code `value`
  no_encoder,  ///< it is another kind of device
  wrong_steps,
  wrong_turns,
  wrong_mapping,  ///< its first PDO does not carry the position first, or the speed second
  wrong_identifier,
};
/// Why an encoder cannot be used: the failure, and the object of its dictionary that shows it.
struct alignas(8) EncoderTrouble {
  std::uint32_t value = 0;
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  EncoderFailure failure = EncoderFailure::none;
  friend bool operator==(const EncoderTrouble&, const EncoderTrouble&) = default;
};

/// For the user: what is wrong, where, and what would be right. Empty without trouble. Not real time.
[[nodiscard]] std::string sentence(const EncoderTrouble& trouble, const Encoder& encoder);

/// A position, at the encoder's shaft.
struct EncoderPosition {
  double angle_rad = 0;                                           ///< from 0 to turns
  double speed_rad_s = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not reported
  std::int64_t time_ns = 0;                                       ///< of the SYNC that it was measured at
};

/// Starts an encoder and asks it for its position. Checks device type, resolution and mapping, has its first
/// PDO sent with every SYNC, starts it, and sends SYNC. The SYNC makes the times of the positions ours. A
/// timer of the encoder would drift against the reads by up to one of them. An encoder that is silent, or has
/// started anew, is started from the beginning. One that is not as configured reports nothing and is asked
/// again after a second. The setting is not stored in the encoder. Fixed memory, real-time safe.
class EncoderReader {
 public:
  /// @param encoder       valid
  /// @param period_reads  from one SYNC to the next
  EncoderReader(const Encoder& encoder, std::uint32_t period_reads) noexcept
      : encoder_(encoder), period_reads_(period_reads) {}

  /// Takes a frame of its bus. ok: `position` is new.
  [[nodiscard]] DecodeStatus take(std::int64_t now_ns, const CanFrame& frame,
                                  EncoderPosition& position) noexcept;
  /// Once per read, after the frames that arrived: what is to be sent, if anything.
  [[nodiscard]] std::optional<CanFrame> step(std::int64_t now_ns) noexcept;

  /// From any thread.
  [[nodiscard]] EncoderTrouble trouble() const noexcept { return trouble_.load(std::memory_order_relaxed); }

 private:
  /// In this order.
  enum class Stage : std::uint8_t {
    stop,
    device_type,
    operating_status,
    steps,
    turns,
    entries,
    first_entry,
    second_entry,
    identifier,
    transmission,
    heartbeat,
    start,
    operational,
    rest,
  };

  [[nodiscard]] Object object_of(Stage stage) const noexcept;
  [[nodiscard]] CanFrame request() const noexcept;
  [[nodiscard]] bool skipped(Stage stage) const noexcept;
  void next_stage() noexcept;
  void begin(std::int64_t now_ns) noexcept;
  void fail(std::int64_t now_ns, EncoderFailure failure, std::uint32_t value) noexcept;
  void judge(std::int64_t now_ns, const SdoAnswer& answer) noexcept;
  [[nodiscard]] EncoderFailure mistake(std::uint32_t value) const noexcept;
  [[nodiscard]] DecodeStatus take_position(std::int64_t now_ns, const CanFrame& frame,
                                           EncoderPosition& position) noexcept;
  [[nodiscard]] std::optional<CanFrame> ask(std::int64_t now_ns) noexcept;
  [[nodiscard]] std::optional<CanFrame> synchronise(std::int64_t now_ns) noexcept;

  Encoder encoder_;
  std::uint32_t period_reads_;
  Stage stage_ = Stage::stop;
  unsigned tries_ = 0;
  std::int64_t deadline_ns_ = 0;  ///< of the stage
  bool scaled_ = false;
  std::uint32_t reads_to_sync_ = 0;
  std::int64_t sync_ns_ = 0;             ///< newest SYNC
  std::int64_t newest_position_ns_ = 0;  ///< or start
  std::atomic<EncoderTrouble> trouble_{};
  static_assert(std::atomic<EncoderTrouble>::is_always_lock_free);
};

/// What it uses of its bus. Start-up only.
[[nodiscard]] NodeIdentifiers identifiers(const Encoder& encoder);
[[nodiscard]] std::vector<FrameId> receive_ids(const Encoder& encoder);
[[nodiscard]] std::vector<PeriodicFrame> periodic_frames(const Encoder& encoder, double sensor_hz);

}  // namespace stilt::hal::canopen
