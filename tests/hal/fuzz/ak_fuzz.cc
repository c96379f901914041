#include <algorithm>

#include "hal/ak/ak_driver.h"
#include "hal/ak/ak_protocol.h"
#include "tests/hal/fuzz/fuzz_input.h"

using namespace stilt::hal;
using namespace stilt::hal::ak;

namespace {

void check_status(const AkDriver& driver, const CanFrame& frame) {
  AkStatus status{.position_rad = 1234};
  if (decode_status(driver, frame, status) != DecodeStatus::ok) {
    fuzz::check(status.position_rad == 1234, "a refused status leaves the output alone");
    return;
  }
  fuzz::check(std::isfinite(status.position_rad) && std::isfinite(status.velocity_rad_s) &&
                  std::isfinite(status.current_A) && std::isfinite(status.driver_temperature_C),
              "a status is finite");
  CanFrame again;
  AkStatus twice;
  fuzz::check(encode_status(driver, status, again) != EncodeStatus::not_finite &&
                  decode_status(driver, again, twice) == DecodeStatus::ok &&
                  twice.position_rad == status.position_rad && twice.fault == status.fault,
              "a status survives encoding");
}

void check_command(const AkDriver& driver, const CanFrame& frame) {
  AkCodes codes;
  if (decode_codes(driver.id, frame, codes) != DecodeStatus::ok) return;
  const AkCommand read = command_of(driver, codes, false);
  fuzz::check(std::abs(read.position_rad) <= driver.position_rad + 1e-9 &&
                  std::abs(read.torque_Nm) <= driver.torque_Nm + 1e-9 && read.kp_Nm_rad >= 0 &&
                  read.kd_Nms_rad >= 0,
              "a command is within its ranges");
  AkCommand command;
  if (decode_command(driver, frame, command) != DecodeStatus::ok) return;
  CanFrame again;
  fuzz::check(encode_command(driver, command, again) != EncodeStatus::not_finite && again.id == frame.id &&
                  std::ranges::equal(again.payload(), frame.payload()),
              "a command survives encoding");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Input input(bytes, size);
  AkDriver driver;
  driver.id = input.byte();
  driver.position_frames = (input.byte() & 1) != 0;
  const std::uint32_t what = input.byte() & 0x3f;
  CanFrame frame = input.frame(what << 8 | driver.id);
  std::fill(frame.data.begin() + std::min<std::ptrdiff_t>(frame.length, 64), frame.data.end(),
            std::uint8_t{0});
  check_status(driver, frame);
  check_command(driver, frame);
  DriverReading reading;
  const DecodeStatus status = take_frame(driver, frame, reading);
  fuzz::check(status == DecodeStatus::ok || !reading.has_motion, "a refused frame is no reading");
  fuzz::check(
      !reading.has_motion || (std::isfinite(reading.position_rad) && std::isfinite(reading.velocity_rad_s)),
      "a reading is finite");
  double position_rad = 0;
  if (decode_position(driver, frame, position_rad) == DecodeStatus::ok)
    fuzz::check(std::isfinite(position_rad), "a position is finite");
  return 0;
}
