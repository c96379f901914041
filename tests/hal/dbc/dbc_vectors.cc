// Prints frames as the codecs encode them, with the values they were encoded from, a line per frame:
//
//   ID BYTES SIGNAL=VALUE ...
//
// for dbc_test.py, which reads the same bytes with the DBC files of hal and an independent DBC reader.
#include <cstdio>
#include <initializer_list>
#include <numbers>
#include <string>
#include <utility>

#include "hal/ak/ak_protocol.h"
#include "hal/mit/mit_mode.h"
#include "hal/odrive/odrive_cansimple.h"
#include "tests/hal/hex.h"
#include "tests/hal/random_values.h"

using namespace stilt::hal;
using namespace stilt::hal::mit;
using namespace stilt::hal::odrive;

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

void print(EncodeStatus status, const CanFrame& frame,
           std::initializer_list<std::pair<const char*, double>> signals) {
  if (status != EncodeStatus::ok) return;
  std::printf("%u %s", frame.id, testing::hex(frame).c_str());
  for (const auto& [signal, value] : signals) std::printf(" %s=%.9g", signal, value);
  std::printf("\n");
}

void print_mit(std::uint8_t joint, testing::RandomValues& random) {
  MitDriver driver;
  driver.command_id = driver.driver_id = joint;
  CanFrame frame;
  MitCommand command{random.between(-12, 12), random.between(-60, 60), random.between(0, 500),
                     random.between(0, 5), random.between(-18, 18)};
  if (encode_command(driver, command, frame) != EncodeStatus::ok ||
      decode_command(driver, frame, command) != DecodeStatus::ok) {
    return;
  }
  print(EncodeStatus::ok, frame,
        {{"position_rad", command.position_rad},
         {"velocity_rad_s", command.velocity_rad_s},
         {"kp_Nm_rad", command.kp_Nm_rad},
         {"kd_Nms_rad", command.kd_Nms_rad},
         {"torque_Nm", command.torque_Nm}});
  MitReply reply;
  reply.position_rad = command.position_rad;
  reply.velocity_rad_s = command.velocity_rad_s;
  reply.torque_Nm = command.torque_Nm;
  print(encode_reply(driver, reply, frame), frame,
        {{"driver_id", joint},
         {"position_rad", reply.position_rad},
         {"velocity_rad_s", reply.velocity_rad_s},
         {"torque_Nm", reply.torque_Nm}});
  driver.layout = ReplyLayout::damiao;
  driver.reply_id = static_cast<std::uint16_t>(0x10 + joint);
  reply.fault_code = static_cast<std::uint8_t>(random.below(16));
  reply.driver_temperature_C = random.below(100);
  reply.motor_temperature_C = random.below(100);
  print(encode_reply(driver, reply, frame), frame,
        {{"status", reply.fault_code},
         {"driver_id", joint},
         {"position_rad", reply.position_rad},
         {"velocity_rad_s", reply.velocity_rad_s},
         {"torque_Nm", reply.torque_Nm},
         {"driver_temperature_C", reply.driver_temperature_C},
         {"motor_temperature_C", reply.motor_temperature_C}});
}

void print_ak(std::uint8_t id, testing::RandomValues& random) {
  const ak::AkDriver driver{.id = id};
  CanFrame frame;
  ak::AkCommand command{random.between(-12, 12), random.between(-60, 60), random.between(0, 500),
                        random.between(0, 5), random.between(-18, 18)};
  if (encode_command(driver, command, frame) != EncodeStatus::ok ||
      decode_command(driver, frame, command) != DecodeStatus::ok) {
    return;
  }
  print(EncodeStatus::ok, frame,
        {{"kp_Nm_rad", command.kp_Nm_rad},
         {"kd_Nms_rad", command.kd_Nms_rad},
         {"position_rad", command.position_rad},
         {"velocity_rad_s", command.velocity_rad_s},
         {"torque_Nm", command.torque_Nm}});
  const bool in_flash = random.chance(0.5);
  print(EncodeStatus::ok, origin_frame(driver, in_flash), {{"in_flash", in_flash}});
  constexpr double kDegree = std::numbers::pi / 180;
  const double degrees = 0.1 * (random.below(64'000) - 32'000.0);
  const double speed_rpm = 10 * (random.below(60'000) - 30'000.0);
  const double current_A = 0.01 * (random.below(12'000) - 6'000.0);
  const double temperature_C = random.below(148) - 20.0;
  const ak::AkStatus status{.position_rad = degrees * kDegree,
                            .velocity_rad_s = speed_rpm * kTurn / 60 / driver.pole_pairs / driver.gear_ratio,
                            .current_A = current_A,
                            .driver_temperature_C = temperature_C,
                            .code = static_cast<std::uint8_t>(random.below(8))};
  print(encode_status(driver, status, frame), frame,
        {{"position_deg", degrees},
         {"speed_electrical_rpm", speed_rpm},
         {"current_A", current_A},
         {"driver_temperature_C", temperature_C},
         {"error", status.code}});
  print(encode_position(driver, degrees * kDegree, 4, frame), frame, {{"position_deg", degrees}});
  print(EncodeStatus::ok, start_frame(driver), {{"mark", 0xfafbfcfd}});
}

void print_odrive_replies(std::uint8_t node, testing::RandomValues& random) {
  CanFrame frame;
  print(encode(node, OdriveVersion{2, 4, 4, 58, 0, 6, 11, 1}, frame), frame,
        {{"protocol", 2},
         {"hardware_line", 4},
         {"hardware_version", 4},
         {"hardware_variant", 58},
         {"firmware_major", 0},
         {"firmware_minor", 6},
         {"firmware_revision", 11},
         {"firmware_unreleased", 1}});
  const std::uint32_t errors = random.below(0xffffffff);
  print(encode(node, OdriveHeartbeat{errors, 8, 3, true}, frame), frame,
        {{"errors", errors}, {"state", 8}, {"procedure_result", 3}, {"trajectory_done", 1}});
  print(encode(node, OdriveErrors{errors, 7}, frame), frame, {{"active", errors}, {"disarm_reason", 7}});
  const double first = random.between(-50, 50);
  const double second = random.between(-50, 50);
  print(encode(node, OdriveEstimates{first, second}, frame), frame,
        {{"position_rev", first / kTurn}, {"velocity_rev_s", second / kTurn}});
  print(encode(node, OdriveTorques{first, second}, frame), frame,
        {{"target_Nm", first}, {"estimate_Nm", second}});
  print(encode(node, OdriveTemperatures{first, second}, frame), frame,
        {{"driver_C", first}, {"motor_C", second}});
  print(encode(node, OdriveSupply{first, second}, frame), frame,
        {{"voltage_V", first}, {"current_A", second}});
}

void print_odrive_commands(std::uint8_t node, testing::RandomValues& random) {
  CanFrame frame;
  print(encode_set_state(node, 8, frame), frame, {{"state", 8}});
  print(encode_set_controller_mode(node, OdriveControlMode::torque, OdriveInputMode::passthrough, frame),
        frame, {{"control_mode", 1}, {"input_mode", 1}});
  const double position_rev = random.between(-9, 9);
  const double velocity_rev_s = 0.001 * (random.below(60'000) - 30'000.0);
  const double torque_Nm = 0.001 * (random.below(60'000) - 30'000.0);
  print(encode_input_position(node, position_rev * kTurn, velocity_rev_s * kTurn, torque_Nm, frame), frame,
        {{"position_rev", position_rev}, {"velocity_rev_s", velocity_rev_s}, {"torque_Nm", torque_Nm}});
  print(encode_input_torque(node, torque_Nm, frame), frame, {{"torque_Nm", torque_Nm}});
  print(encode_clear_errors(node, frame), frame, {{"identify", 0}});
}

}  // namespace

int main() {
  testing::RandomValues random(4801);
  for (int round = 0; round < 20; ++round) {
    for (std::uint8_t joint = 1; joint <= 4; ++joint) {
      print_mit(joint, random);
      print_ak(joint, random);
      print_odrive_replies(joint, random);
      print_odrive_commands(joint, random);
    }
  }
  return 0;
}
