#include <linux/can/error.h>

#include <cstdio>
#include <span>
#include <string_view>

#include "hal/can/socketcan/socketcan_bus.h"

/// send_error_frame INTERFACE warning|passive|bus-off: what a CAN controller reports of itself, for everyone
/// on the interface to receive. For vcan, which has no controller.
namespace {

using namespace stilt::hal;

struct Kind {
  std::string_view name;
  std::uint32_t id;
  std::uint8_t detail;  ///< byte 1
};

constexpr Kind kKinds[] = {{"warning", CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING},
                           {"passive", CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE},
                           {"bus-off", CAN_ERR_BUSOFF, 0}};

bool send(const char* interface, const Kind& kind) {
  CanFrame frame;
  frame.error = true;
  frame.id = kind.id;
  frame.length = CAN_ERR_DLC;
  frame.data[1] = kind.detail;
  socketcan::SocketCanBus bus;
  return bus.open(interface, {}) && bus.frames().send(std::span(&frame, 1)).sent == 1;
}

}  // namespace

int main(int argc, char** argv) {
  for (const Kind& kind : kKinds) {
    if (argc == 3 && argv[2] == kind.name) return send(argv[1], kind) ? 0 : 1;
  }
  std::fprintf(stderr, "usage: send_error_frame INTERFACE warning|passive|bus-off\n");
  return 2;
}
