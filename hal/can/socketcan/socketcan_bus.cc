#include "hal/can/socketcan/socketcan_bus.h"

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <cstring>

namespace stilt::hal::socketcan {
namespace {

/// Where opening failed; the sentence is made later, so that reopening allocates nothing.
enum class Step : std::uint8_t { none, name, socket, find, flags, down, mtu, classic, option, bind };

struct Attempt {
  Descriptor descriptor;
  Step failed = Step::none;
  int error_number = 0;
};

Attempt fail(Step step) noexcept { return {Descriptor{}, step, errno}; }

std::vector<can_filter> kernel_filters(const BusOptions& options) {
  std::vector<can_filter> filters;
  filters.reserve(options.receive_ids.size());
  for (const FrameId& wanted : options.receive_ids) {
    // The format flag is part of the mask: a standard identifier must not match an extended one.
    filters.push_back(wanted.extended ? can_filter{wanted.id | CAN_EFF_FLAG, CAN_EFF_MASK | CAN_EFF_FLAG}
                                      : can_filter{wanted.id, CAN_SFF_MASK | CAN_EFF_FLAG});
  }
  return filters;
}

template <class Value>
bool set(int descriptor, int level, int option, const Value& value) noexcept {
  return ::setsockopt(descriptor, level, option, &value, sizeof value) == 0;
}

bool set_options(int descriptor, const BusOptions& options, const std::vector<can_filter>& filters) noexcept {
  const int on = 1;
  const can_err_mask_t all_errors = CAN_ERR_MASK;
  if (!filters.empty() && ::setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                                       static_cast<socklen_t>(filters.size() * sizeof(can_filter))) != 0) {
    return false;
  }
  return set(descriptor, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, all_errors) &&
         set(descriptor, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, on) &&
         (!options.fd || set(descriptor, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, on)) &&
         set(descriptor, SOL_SOCKET, SO_RXQ_OVFL, on) &&
         set(descriptor, SOL_SOCKET, SO_RCVBUF, options.receive_buffer_bytes);
}

Attempt attempt(const std::string& interface, const BusOptions& options,
                const std::vector<can_filter>& filters) noexcept {
  if (interface.empty() || interface.size() >= IFNAMSIZ) return fail(Step::name);
  Descriptor descriptor(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (!descriptor.open()) return fail(Step::socket);
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  if (::ioctl(descriptor.get(), SIOCGIFINDEX, &request) != 0) return fail(Step::find);
  const int index = request.ifr_ifindex;
  if (::ioctl(descriptor.get(), SIOCGIFFLAGS, &request) != 0) return fail(Step::flags);
  if ((request.ifr_flags & IFF_UP) == 0) return fail(Step::down);
  if (::ioctl(descriptor.get(), SIOCGIFMTU, &request) != 0) return fail(Step::mtu);
  if (options.fd && request.ifr_mtu < static_cast<int>(CANFD_MTU)) return fail(Step::classic);
  if (!set_options(descriptor.get(), options, filters)) return fail(Step::option);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index;
  if (::bind(descriptor.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return fail(Step::bind);
  }
  return {std::move(descriptor), Step::none, 0};
}

/// Rates alone leave sample points to the kernel, at 75 to 87.5 %, where a moteus does not follow. At 40 MHz
/// a bit of data has 8 quanta, 2 and 3 of them in its phases: kernels from 6.3 on refuse a longer jump.
std::string fd_timing(const std::string& interface, const BusOptions& options) {
  return "`dbitrate " + std::to_string(options.data_bit_rate_bit_s) +
         " fd on sample-point 0.666 dsample-point 0.666 sjw 10 dsjw 5`, or `dsjw 2` where "
         "`ip "
         "-details link show " +
         interface + "` shows clock 40000000";
}

std::string sentence(const std::string& interface, const BusOptions& options, const Attempt& failed) {
  const std::string reason = std::strerror(failed.error_number);
  switch (failed.failed) {
    case Step::name:
      return "bus '" + interface + "': an interface name has 1 to 15 characters, like can0";
    case Step::socket:
      if (failed.error_number == EAFNOSUPPORT) {
        return "bus " + interface +
               ": this kernel has no CAN (module can-raw); without hardware use loopback:NAME";
      }
      return "bus " + interface + ": no CAN socket: " + reason;
    case Step::find:
      return "bus " + interface + ": no such interface; `ip link` lists those there are";
    case Step::down:
      return down_sentence(interface, options);
    case Step::classic:
      return classic_sentence(interface, options);
    case Step::flags:
    case Step::mtu:
    case Step::option:
    case Step::bind:
    case Step::none:
      break;
  }
  return "bus " + interface + ": cannot be set up: " + reason;
}

}  // namespace

std::string down_sentence(const std::string& interface, const BusOptions& options) {
  return "bus " + interface + ": the interface is down; bring it up with `ip link set " + interface +
         " up type can bitrate " + std::to_string(options.bit_rate_bit_s) + "`, with CAN FD also " +
         fd_timing(interface, options);
}

std::string classic_sentence(const std::string& interface, const BusOptions& options) {
  return "bus " + interface +
         ": the interface carries no CAN FD frames, which a moteus and can_fd = true need; set it up with " +
         fd_timing(interface, options);
}

std::expected<void, std::string> SocketCanBus::open(const std::string& interface, const BusOptions& options) {
  interface_ = interface;
  options_ = options;
  filters_ = kernel_filters(options);
  Attempt opened = attempt(interface_, options_, filters_);
  if (opened.failed != Step::none) return std::unexpected(sentence(interface_, options_, opened));
  descriptor_ = std::move(opened.descriptor);
  socket_.reset(descriptor_.get());
  return {};
}

bool SocketCanBus::reopen() noexcept {
  Attempt opened = attempt(interface_, options_, filters_);
  if (opened.failed != Step::none) return false;
  descriptor_ = std::move(opened.descriptor);
  socket_.reset(descriptor_.get());
  return true;
}

}  // namespace stilt::hal::socketcan
