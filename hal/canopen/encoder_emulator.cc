#include "hal/canopen/encoder_emulator.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "hal/can/bytes.h"

namespace stilt::hal::canopen {
namespace {

constexpr std::uint32_t kNoObject = 0x06020000;  // abort codes of CiA 301, 7.2.4.3.17
constexpr std::uint32_t kWrongLength = 0x06070010;
constexpr std::uint32_t kWhenDeviceLikes = 254;  // transmission types of CiA 301, 7.5.2.37
constexpr std::uint32_t kLastSynchronous = 240;
constexpr std::uint32_t kSingleTurn = 0x00010000, kMultiTurn = 0x00020000;
constexpr std::int64_t kMillisecond_ns = 1'000'000;

}  // namespace

EncoderEmulator::EncoderEmulator(const Encoder& encoder) : encoder_(encoder) {
  const bool has_speed = encoder.speed_rad_s != 0;
  factory_ = {{objects::kDeviceType, (encoder.turns > 1 ? kMultiTurn : kSingleTurn) | kEncoderProfile},
              {objects::kHeartbeatTime, 0, 2},
              {objects::kPdoIdentifier, tpdo1_id(encoder.node)},
              {objects::kPdoTransmission, kWhenDeviceLikes, 1},
              {objects::kPdoEntries, has_speed ? 2u : 1u, 1},
              {objects::kPdoFirst, kPositionEntry},
              {objects::kOperatingStatus, 0, 2},
              {objects::kSteps, encoder.steps_per_turn},
              {objects::kTurns, encoder.turns, 2}};
  if (has_speed) factory_.push_back({objects::kPdoSecond, kSpeedEntry});
  objects_ = factory_;
}

EncoderEmulator::Entry* EncoderEmulator::find(const Object& object) noexcept {
  const auto found = std::ranges::find(objects_, object, &Entry::object);
  return found == objects_.end() ? nullptr : &*found;
}

std::uint32_t EncoderEmulator::value_of(const Object& object) noexcept {
  const Entry* entry = find(object);
  return entry == nullptr ? 0 : entry->value;
}

void EncoderEmulator::set_object(const Object& object, std::uint32_t value) {
  for (std::vector<Entry>* list : {&factory_, &objects_}) {
    const auto found = std::ranges::find(*list, object, &Entry::object);
    if (found == list->end()) {
      list->push_back({object, value});
    } else {
      found->value = value;
    }
  }
}

void EncoderEmulator::remove_object(const Object& object) {
  for (std::vector<Entry>* list : {&factory_, &objects_})
    std::erase_if(*list, [&object](const Entry& entry) { return entry.object == object; });
}

void EncoderEmulator::set_motion(double angle_rad, double speed_rad_s) noexcept {
  const double range = static_cast<double>(encoder_.steps_per_turn) * encoder_.turns;
  const double steps = std::floor(angle_rad / kRadiansPerRevolution * encoder_.steps_per_turn);
  position_ = static_cast<std::uint32_t>(steps - range * std::floor(steps / range));
  if (encoder_.speed_rad_s == 0) return;
  const double speed = std::round(speed_rad_s / encoder_.speed_rad_s);
  speed_ = static_cast<std::int16_t>(std::clamp(speed, -32768.0, 32767.0));
}

void EncoderEmulator::power_cycle() {
  objects_ = factory_;
  state_ = NmtState::boot_up;
}

CanFrame EncoderEmulator::position_frame() noexcept {
  const bool has_speed = encoder_.speed_rad_s != 0;
  CanFrame frame = classic_frame(tpdo1_id(encoder_.node), has_speed ? 6 : 4);
  store_little(std::span(frame.data).first(4), position_);
  if (has_speed) store_little(std::span(frame.data).subspan(4, 2), static_cast<std::uint16_t>(speed_));
  return frame;
}

void EncoderEmulator::change_state(NmtCommand command, FrameSink& replies) {
  switch (command) {
    case NmtCommand::start:
      if (state_ != NmtState::operational) replies.push(position_frame());
      state_ = NmtState::operational;
      break;
    case NmtCommand::stop:
      state_ = NmtState::stopped;
      break;
    case NmtCommand::enter_pre_operational:
      state_ = NmtState::pre_operational;
      break;
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      power_cycle();
      break;
  }
}

SdoAnswer EncoderEmulator::answer(const SdoRequest& request, std::uint8_t& bytes) noexcept {
  Entry* entry = find(request.object);
  if (entry == nullptr) return {SdoAnswer::Kind::aborted, request.object, kNoObject};
  bytes = entry->bytes;
  if (!request.write) return {SdoAnswer::Kind::value, request.object, entry->value};
  if (request.bytes != 0 && request.bytes != entry->bytes)
    return {SdoAnswer::Kind::aborted, request.object, kWrongLength};
  entry->value = request.value;
  return {SdoAnswer::Kind::written, request.object, 0};
}

void EncoderEmulator::take(std::int64_t now_ns, const CanFrame& frame, FrameSink& replies) {
  if (state_ == NmtState::boot_up) return;
  const bool is_data = !frame.extended && !frame.remote && !frame.error;
  if (is_data && frame.id == kNmtId && frame.length == 2 &&
      (frame.data[1] == encoder_.node || frame.data[1] == 0)) {
    change_state(static_cast<NmtCommand>(frame.data[0]), replies);
    next_heartbeat_ns_ = now_ns;
    return;
  }
  if (is_data && frame.id == kSyncId) {
    const std::uint32_t type = value_of(objects::kPdoTransmission);
    const bool sends = state_ == NmtState::operational && type >= 1 && type <= kLastSynchronous;
    if (sends) replies.push(position_frame());
    return;
  }
  SdoRequest request;
  if (state_ == NmtState::stopped || decode_request(encoder_.node, frame, request) != DecodeStatus::ok)
    return;
  std::uint8_t bytes = 4;
  const SdoAnswer said = answer(request, bytes);
  replies.push(answer_frame(encoder_.node, said, bytes));
}

void EncoderEmulator::elapse(std::int64_t now_ns, FrameSink& replies) {
  if (state_ == NmtState::boot_up) {
    state_ = NmtState::pre_operational;
    replies.push(heartbeat_frame(encoder_.node, NmtState::boot_up));
  }
  const std::int64_t period_ns = kMillisecond_ns * value_of(objects::kHeartbeatTime);
  if (period_ns == 0 || now_ns < next_heartbeat_ns_) return;
  next_heartbeat_ns_ = now_ns + period_ns;
  replies.push(heartbeat_frame(encoder_.node, state_));
}

}  // namespace stilt::hal::canopen
