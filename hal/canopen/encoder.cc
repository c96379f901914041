#include "hal/canopen/encoder.h"

#include <cmath>
#include <span>

#include "hal/can/bytes.h"

namespace stilt::hal::canopen {
namespace {

constexpr std::int64_t kSettle_ns = 20'000'000;  // of a node that was commanded to leave or enter a state
constexpr std::int64_t kAnswer_ns = 50'000'000;
constexpr unsigned kTries = 3;
constexpr std::int64_t kRest_ns = 1'000'000'000;   // before it is asked again
constexpr std::int64_t kSilence_ns = 200'000'000;  // without a position
constexpr std::uint32_t kEverySync = 1;
constexpr std::uint32_t kHeartbeat_ms = 100;
constexpr std::uint32_t kIdentifierMask = 0x80000000 | kMaximumExtendedId;  // bit 31: not in use
constexpr std::uint8_t kPositionBytes = 4, kSpeedBytes = 2;

}  // namespace

bool valid(const Encoder& encoder) noexcept {
  constexpr std::uint64_t kPositions = std::uint64_t{1} << 32;
  return encoder.node >= 1 && encoder.node <= kMaximumNode && encoder.steps_per_turn >= 2 &&
         encoder.turns >= 1 && std::uint64_t{encoder.steps_per_turn} * encoder.turns <= kPositions &&
         std::isfinite(encoder.speed_rad_s);
}

Object EncoderReader::object_of(Stage stage) const noexcept {
  switch (stage) {
    case Stage::device_type:
      return objects::kDeviceType;
    case Stage::operating_status:
      return objects::kOperatingStatus;
    case Stage::steps:
      return scaled_ ? objects::kScaledSteps : objects::kSteps;
    case Stage::turns:
      return scaled_ ? objects::kScaledRange : objects::kTurns;
    case Stage::entries:
      return objects::kPdoEntries;
    case Stage::first_entry:
      return objects::kPdoFirst;
    case Stage::second_entry:
      return objects::kPdoSecond;
    case Stage::identifier:
      return objects::kPdoIdentifier;
    case Stage::transmission:
      return objects::kPdoTransmission;
    case Stage::heartbeat:
      return objects::kHeartbeatTime;
    case Stage::stop:
    case Stage::start:
    case Stage::operational:
    case Stage::rest:
      break;
  }
  return {};
}

CanFrame EncoderReader::request() const noexcept {
  switch (stage_) {
    case Stage::stop:
      return nmt_frame(NmtCommand::enter_pre_operational, encoder_.node);
    case Stage::start:
      return nmt_frame(NmtCommand::start, encoder_.node);
    case Stage::transmission:
      return sdo_write_frame(encoder_.node, objects::kPdoTransmission, kEverySync, 1);
    case Stage::heartbeat:
      return sdo_write_frame(encoder_.node, objects::kHeartbeatTime, kHeartbeat_ms, 2);
    default:
      return sdo_read_frame(encoder_.node, object_of(stage_));
  }
}

bool EncoderReader::skipped(Stage stage) const noexcept {
  return stage == Stage::second_entry && encoder_.speed_rad_s == 0;
}

void EncoderReader::next_stage() noexcept {
  do {
    stage_ = static_cast<Stage>(static_cast<std::uint8_t>(stage_) + 1);
  } while (skipped(stage_));
  tries_ = 0;
  deadline_ns_ = 0;
  reads_to_sync_ = 0;
}

void EncoderReader::begin(std::int64_t now_ns) noexcept {
  stage_ = Stage::stop;
  tries_ = 0;
  deadline_ns_ = now_ns;
  scaled_ = false;
}

void EncoderReader::fail(std::int64_t now_ns, EncoderFailure failure, std::uint32_t value) noexcept {
  const Object object = object_of(stage_);
  trouble_.store({value, object.index, object.subindex, failure}, std::memory_order_relaxed);
  stage_ = Stage::rest;
  deadline_ns_ = now_ns + kRest_ns;
}

/// Of the answer in this stage; none: it is valid.
EncoderFailure EncoderReader::mistake(std::uint32_t value) const noexcept {
  const std::uint64_t range = std::uint64_t{encoder_.steps_per_turn} * encoder_.turns;
  const auto unless = [](bool right, EncoderFailure failure) {
    return right ? EncoderFailure::none : failure;
  };
  switch (stage_) {
    case Stage::device_type:
      return unless((value & 0xffff) == kEncoderProfile, EncoderFailure::no_encoder);
    case Stage::steps:
      return unless(value == encoder_.steps_per_turn, EncoderFailure::wrong_steps);
    case Stage::turns:  // the turns are an object of 16 bits; a range of all 32 reads 0
      return unless(scaled_ ? value == static_cast<std::uint32_t>(range)
                            : (value & 0xffff) == (encoder_.turns & 0xffff),
                    EncoderFailure::wrong_turns);
    case Stage::entries:
      return unless(value >= (encoder_.speed_rad_s == 0 ? 1u : 2u), EncoderFailure::wrong_mapping);
    case Stage::first_entry:
      return unless(value == kPositionEntry, EncoderFailure::wrong_mapping);
    case Stage::second_entry:
      return unless(value == kSpeedEntry, EncoderFailure::wrong_mapping);
    case Stage::identifier:
      return unless((value & kIdentifierMask) == tpdo1_id(encoder_.node), EncoderFailure::wrong_identifier);
    default:
      return EncoderFailure::none;
  }
}

/// Not every encoder has the objects of its resolution, nor a heartbeat.
void EncoderReader::judge(std::int64_t now_ns, const SdoAnswer& answer) noexcept {
  const Object asked = object_of(stage_);
  if (asked.index == 0 || answer.object != asked) return;
  const bool write = stage_ == Stage::transmission || stage_ == Stage::heartbeat;
  if (answer.kind == SdoAnswer::Kind::aborted) {
    const bool optional = stage_ == Stage::operating_status || stage_ == Stage::steps ||
                          stage_ == Stage::turns || stage_ == Stage::identifier || stage_ == Stage::heartbeat;
    if (!optional) return fail(now_ns, EncoderFailure::aborted, answer.value);
    return next_stage();
  }
  if ((answer.kind == SdoAnswer::Kind::written) != write) return;
  if (const EncoderFailure failure = mistake(answer.value); failure != EncoderFailure::none)
    return fail(now_ns, failure, answer.value);
  if (stage_ == Stage::operating_status) scaled_ = (answer.value & kScalingOn) != 0;
  next_stage();
}

DecodeStatus EncoderReader::take_position(std::int64_t now_ns, const CanFrame& frame,
                                          EncoderPosition& position) noexcept {
  const bool has_speed = encoder_.speed_rad_s != 0;
  const std::uint8_t least = has_speed ? kPositionBytes + kSpeedBytes : kPositionBytes;
  if (frame.length < least) return DecodeStatus::wrong_length;
  const auto steps = static_cast<double>(load_little(frame.payload().first(kPositionBytes)));
  EncoderPosition now;
  now.angle_rad = kRadiansPerRevolution * steps / encoder_.steps_per_turn;
  if (has_speed) {
    const std::uint64_t raw = load_little(frame.payload().subspan(kPositionBytes, kSpeedBytes));
    now.speed_rad_s = encoder_.speed_rad_s * static_cast<double>(sign_extend(raw, 8 * kSpeedBytes));
  }
  now.time_ns = sync_ns_;
  position = now;
  newest_position_ns_ = now_ns;
  trouble_.store({}, std::memory_order_relaxed);
  return DecodeStatus::ok;
}

/// An encoder sends its first position unasked when it is started: that one belongs to no SYNC.
DecodeStatus EncoderReader::take(std::int64_t now_ns, const CanFrame& frame,
                                 EncoderPosition& position) noexcept {
  if (frame.remote || frame.error || frame.fd || frame.extended) return DecodeStatus::not_addressed;
  if (frame.id == tpdo1_id(encoder_.node)) {
    return stage_ == Stage::operational ? take_position(now_ns, frame, position)
                                        : DecodeStatus::not_addressed;
  }
  if (const auto state = decode_heartbeat(encoder_.node, frame)) {
    const bool stopped = stage_ == Stage::operational && *state != NmtState::operational;
    if (*state == NmtState::boot_up || stopped) begin(now_ns);
    return DecodeStatus::not_addressed;
  }
  SdoAnswer answer;
  const DecodeStatus status = decode_answer(encoder_.node, frame, answer);
  if (status != DecodeStatus::ok) return status;
  judge(now_ns, answer);
  return DecodeStatus::not_addressed;
}

/// The present stage's request, again after a while without an answer.
std::optional<CanFrame> EncoderReader::ask(std::int64_t now_ns) noexcept {
  if (now_ns < deadline_ns_) return std::nullopt;
  const auto is_command = [this] { return stage_ == Stage::stop || stage_ == Stage::start; };
  if (is_command() && tries_ > 0) {  // its time to settle is over
    next_stage();
    if (stage_ == Stage::operational) {
      newest_position_ns_ = now_ns;
      return synchronise(now_ns);
    }
  }
  if (tries_ == kTries) {
    fail(now_ns, EncoderFailure::silent, 0);
    return std::nullopt;
  }
  ++tries_;
  deadline_ns_ = now_ns + (is_command() ? kSettle_ns : kAnswer_ns);
  return request();
}

std::optional<CanFrame> EncoderReader::synchronise(std::int64_t now_ns) noexcept {
  if (reads_to_sync_ > 0) {
    --reads_to_sync_;
    return std::nullopt;
  }
  reads_to_sync_ = period_reads_ - 1;
  sync_ns_ = now_ns;
  return sync_frame();
}

std::optional<CanFrame> EncoderReader::step(std::int64_t now_ns) noexcept {
  if (stage_ == Stage::rest) {
    if (now_ns < deadline_ns_) return std::nullopt;
    begin(now_ns);
  }
  if (stage_ != Stage::operational) return ask(now_ns);
  if (now_ns - newest_position_ns_ <= kSilence_ns) return synchronise(now_ns);
  fail(now_ns, EncoderFailure::silent, 0);
  begin(now_ns);
  return ask(now_ns);
}

}  // namespace stilt::hal::canopen
