#include "hal/odrive/odrive_driver.h"

namespace stilt::hal::odrive {
namespace {

constexpr std::uint32_t kCommands = 32;  // per node
constexpr std::uint32_t kNodeMask = kMaximumStandardId & ~(kCommands - 1);
constexpr std::uint32_t kEverybody = 0x3f;
constexpr double kHeartbeat_hz = 100;       // as documented: heartbeat_msg_rate_ms 10
constexpr double kTorques_hz = 200;         // torques_msg_rate_ms 5
constexpr double kQuestionsPerTick = 0.02;  // supply and temperatures (CanRobot)

}  // namespace

NodeIdentifiers identifiers(const OdriveDriver& driver) {
  const IdPattern own{.value = driver.node * kCommands, .mask = kNodeMask};
  const IdPattern everybody{.value = kEverybody * kCommands, .mask = kNodeMask};
  return {{own}, {own, everybody}, {own}, {}};
}

/// Every command of the node, both ways.
std::vector<FrameId> receive_ids(const OdriveDriver& driver) {
  std::vector<FrameId> ids;
  for (std::uint32_t command = 0; command < kCommands; ++command) {
    ids.push_back({driver.node * kCommands + command, false});
  }
  return ids;
}

std::vector<PeriodicFrame> periodic_frames(const OdriveDriver&, double tick_hz) {
  const double questions_hz = kQuestionsPerTick * tick_hz;
  return {{.length = 4, .rate_hz = tick_hz},  // torque
          {.length = 8, .rate_hz = kOdriveEstimates_hz},
          {.length = 8, .rate_hz = kHeartbeat_hz},
          {.length = 8, .rate_hz = kTorques_hz},
          {.length = 0, .rate_hz = questions_hz},  // remote frames, and the answers
          {.length = 8, .rate_hz = questions_hz}};
}

}  // namespace stilt::hal::odrive
