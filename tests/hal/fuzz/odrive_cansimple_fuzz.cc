#include "hal/odrive/odrive_cansimple.h"
#include "tests/hal/fuzz/fuzz_input.h"

using namespace stilt::hal;
using namespace stilt::hal::odrive;

namespace {

template <class Message>
bool decodes(std::uint8_t node, const CanFrame& frame, Message& message) {
  return decode(node, frame, message) == DecodeStatus::ok;
}

void check_estimates(std::uint8_t node, const CanFrame& frame) {
  OdriveEstimates estimates{1234, 1234};
  if (!decodes(node, frame, estimates)) {
    fuzz::check(estimates.position_rad == 1234, "a refused message leaves the output alone");
    return;
  }
  fuzz::check(std::isfinite(estimates.position_rad) && std::isfinite(estimates.velocity_rad_s),
              "estimates are finite");
}

template <class Message>
void check_words(std::uint8_t node, const CanFrame& frame) {
  Message message;
  if (!decodes(node, frame, message)) return;
  CanFrame again;
  fuzz::check(encode(node, message, again) == EncodeStatus::ok, "a decoded message can be encoded");
  Message twice;
  fuzz::check(decodes(node, again, twice) && twice == message, "a message survives encoding");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Input input(bytes, size);
  const auto node = static_cast<std::uint8_t>(input.byte() & 0x3f);
  const std::uint32_t command = input.byte() & 0x1f;
  const CanFrame frame = input.frame(static_cast<std::uint32_t>(node) << 5 | command);
  check_estimates(node, frame);
  check_words<OdriveVersion>(node, frame);
  check_words<OdriveHeartbeat>(node, frame);
  check_words<OdriveErrors>(node, frame);
  OdriveTorques torques;
  if (decodes(node, frame, torques)) fuzz::check(std::isfinite(torques.estimate_Nm), "torques are finite");
  OdriveTemperatures temperatures;
  if (decodes(node, frame, temperatures))
    fuzz::check(std::isfinite(temperatures.driver_C), "temperature is finite");
  OdriveSupply supply;
  if (decodes(node, frame, supply)) fuzz::check(std::isfinite(supply.voltage_V), "supply is finite");
  OdriveParameter parameter;
  if (decode_parameter_answer(node, frame, parameter) == DecodeStatus::ok) {
    CanFrame again;
    fuzz::check(
        encode_parameter_answer(node, parameter, again) == EncodeStatus::ok && again.length == frame.length,
        "a parameter survives encoding");
  }
  static_cast<void>(decode_parameter_request(node, frame, parameter));
  OdriveCommand what{};
  static_cast<void>(decode_command(node, frame, what));
  std::uint32_t state = 0;
  std::uint32_t mode = 0;
  static_cast<void>(decode_set_state(node, frame, state));
  static_cast<void>(decode_set_controller_mode(node, frame, state, mode));
  double torque_Nm = 0;
  if (decode_input_torque(node, frame, torque_Nm) == DecodeStatus::ok) {
    fuzz::check(std::isfinite(torque_Nm), "a torque command is finite");
  }
  OdriveInputPosition position;
  if (decode_input_position(node, frame, position) == DecodeStatus::ok) {
    fuzz::check(std::isfinite(position.position_rad), "a position command is finite");
  }
  static_cast<void>(odrive_fault(state));
  return 0;
}
