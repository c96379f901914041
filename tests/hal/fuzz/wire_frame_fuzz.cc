#include "hal/can/socketcan/wire_frame.h"
#include "hal/loopback/loopback_address.h"
#include "tests/hal/fuzz/fuzz_input.h"

using namespace stilt::hal;

// Bytes as they come from a socket: frames of both sizes, and greetings of the loopback bus.
int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto wire = std::as_bytes(std::span(bytes, size));
  CanFrame frame = classic_frame(0x123, 1);
  if (socketcan::from_wire(wire, frame)) {
    fuzz::check(well_formed(frame), "a frame that was read can exist");
    socketcan::WireFrame again;
    const std::size_t sent = socketcan::to_wire(frame, again);
    fuzz::check(sent == size, "a frame keeps its size");
    CanFrame twice;
    fuzz::check(socketcan::from_wire(std::span<const std::byte>(again).first(sent), twice) && twice == frame,
                "a frame survives the wire");
  } else {
    fuzz::check(frame == classic_frame(0x123, 1), "bytes that are no frame leave the output alone");
  }
  loopback::GreetingBytes greeting{};
  std::copy_n(bytes, std::min(size, greeting.size()), greeting.begin());
  static_cast<void>(loopback::read_greeting(greeting, size));
  return 0;
}
