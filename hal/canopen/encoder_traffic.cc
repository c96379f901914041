#include <cstdio>

#include "hal/canopen/encoder.h"

namespace stilt::hal::canopen {
namespace {

constexpr double kHeartbeat_hz = 10;

std::string format(const char* pattern, auto... values) {
  char text[240];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

}  // namespace

NodeIdentifiers identifiers(const Encoder& encoder) {
  const auto one = [](std::uint32_t id) { return IdPattern{.value = id, .mask = kMaximumStandardId}; };
  return {{one(kNmtId), one(kSyncId), one(sdo_request_id(encoder.node))},
          {one(kNmtId), one(kSyncId), one(sdo_request_id(encoder.node))},
          {one(tpdo1_id(encoder.node)), one(sdo_answer_id(encoder.node)), one(heartbeat_id(encoder.node))},
          {}};
}

std::vector<FrameId> receive_ids(const Encoder& encoder) {
  return {{kNmtId, false},
          {kSyncId, false},
          {sdo_request_id(encoder.node), false},
          {tpdo1_id(encoder.node), false},
          {sdo_answer_id(encoder.node), false},
          {heartbeat_id(encoder.node), false}};
}

std::vector<PeriodicFrame> periodic_frames(const Encoder& encoder, double sensor_hz) {
  const std::uint8_t length = encoder.speed_rad_s == 0 ? 4 : 6;
  return {{.length = 0, .rate_hz = sensor_hz},
          {.length = length, .rate_hz = sensor_hz},
          {.length = 1, .rate_hz = kHeartbeat_hz}};
}

std::string sentence(const EncoderTrouble& trouble, const Encoder& encoder) {
  if (trouble.failure == EncoderFailure::none) return "";
  std::string node = "torso sensor: node " + std::to_string(encoder.node);
  const std::string object =
      format(" (object 0x%04x:%u)", unsigned{trouble.index}, unsigned{trouble.subindex});
  switch (trouble.failure) {
    case EncoderFailure::none:
      break;
    case EncoderFailure::silent:
      return node + (trouble.index == 0 ? " sends no positions" : " does not answer" + object) +
             "; see torso_sensor.encoder_node, its bit rate, power and cable";
    case EncoderFailure::aborted:
      return node + " refuses what every encoder of CiA 406 has" + object +
             format(", abort code 0x%08x", trouble.value);
    case EncoderFailure::no_encoder:
      return node + format(" is a device of profile %u, an encoder has 406; see torso_sensor.encoder_node",
                           trouble.value & 0xffff);
    case EncoderFailure::wrong_steps:
      return node + format(" has %u steps per turn", trouble.value) + object +
             format(", torso_sensor.encoder_steps is %u", encoder.steps_per_turn);
    case EncoderFailure::wrong_turns:
      return node + format(" reads %u", trouble.value) + object +
             format(", which is not the %u turns of torso_sensor.encoder_turns", encoder.turns);
    case EncoderFailure::wrong_mapping:
      return node + format(" reads 0x%x", trouble.value) + object +
             (encoder.speed_rad_s == 0 ? ": its first PDO must begin with the position, 0x60040020"
                                       : ": its first PDO must be position and speed, 0x60040020 and "
                                         "0x60300110; or set torso_sensor.encoder_speed_rad_s to 0");
    case EncoderFailure::wrong_identifier:
      return node + format(" reads 0x%x", trouble.value) + object +
             format(": its first PDO must have identifier 0x%x", tpdo1_id(encoder.node));
  }
  return node;
}

}  // namespace stilt::hal::canopen
