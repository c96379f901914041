#include "hal/mit/damiao_registers.h"
#include "hal/mit/mit_mode.h"
#include "tests/hal/fuzz/fuzz_input.h"

using namespace stilt::hal;
using namespace stilt::hal::mit;

namespace {

MitDriver driver_of(std::uint8_t choice) {
  MitDriver driver;
  driver.command_id = 1;
  driver.reply_id = 0x11;
  driver.layout = static_cast<ReplyLayout>(choice % 3);
  if (driver.layout == ReplyLayout::ak && (choice & 0x80) != 0) driver.temperature_offset_C = -40;
  return driver;
}

void check_reply(const MitDriver& driver, const CanFrame& frame) {
  MitReply reply;
  reply.position_rad = 1234;
  const DecodeStatus status = decode_reply(driver, frame, reply);
  if (status != DecodeStatus::ok) {
    fuzz::check(reply.position_rad == 1234, "a refused reply leaves the output alone");
    return;
  }
  fuzz::check(std::abs(reply.position_rad) <= 12.5 && std::abs(reply.velocity_rad_s) <= 65 &&
                  std::abs(reply.torque_Nm) <= 18,
              "a reply is inside its ranges");
  CanFrame again;
  fuzz::check(encode_reply(driver, reply, again) == EncodeStatus::ok, "a decoded reply can be encoded");
  MitReply twice;
  fuzz::check(decode_reply(driver, again, twice) == DecodeStatus::ok &&
                  twice.position_rad == reply.position_rad && twice.velocity_rad_s == reply.velocity_rad_s &&
                  twice.torque_Nm == reply.torque_Nm && twice.fault == reply.fault &&
                  fuzz::same(twice.driver_temperature_C, reply.driver_temperature_C),
              "a reply survives encoding");
}

void check_command(const MitDriver& driver, const CanFrame& frame) {
  MitCommand command;
  if (decode_command(driver, frame, command) != DecodeStatus::ok) return;
  CanFrame again;
  fuzz::check(encode_command(driver, command, again) == EncodeStatus::ok, "a decoded command can be encoded");
  fuzz::check(std::equal(again.data.begin(), again.data.begin() + 8, frame.data.begin()),
              "a command survives encoding");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Input input(bytes, size);
  const std::uint8_t choice = input.byte();
  const MitDriver driver = driver_of(choice);
  const CanFrame frame = input.frame((choice & 0x40) != 0 ? driver.command_id : driver.reply_id);
  check_reply(driver, frame);
  check_command(driver, frame);
  MitSpecial special{};
  MitCommand command;
  fuzz::check(!(decode_special(driver, frame, special) == DecodeStatus::ok &&
                decode_command(driver, frame, command) == DecodeStatus::ok),
              "no frame is both a command and special");
  DamiaoRegisterMessage message;
  if (decode_register_answer(driver, frame, message) == DecodeStatus::ok) {
    CanFrame again;
    fuzz::check(encode_register_answer(driver, message, again) == EncodeStatus::ok &&
                    std::equal(again.data.begin(), again.data.begin() + 8, frame.data.begin()),
                "a register answer survives encoding");
  }
  static_cast<void>(decode_register_request(driver, frame, message));
  return 0;
}
