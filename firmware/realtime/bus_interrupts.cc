#include "firmware/realtime/bus_interrupts.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string_view>

#include "firmware/realtime/kernel_file.h"

namespace stilt::realtime {
namespace {

namespace fs = std::filesystem;

/// The kernel cuts names of threads off there.
constexpr std::size_t kLongestName = 15;

/// What the threads of an adapter are known by.
struct Marks {
  std::set<int> numbers;           ///< of interrupts
  std::vector<std::string> names;  ///< that a thread is called by
  bool softirq = false;            ///< ksoftirqd works for it
};

/// Interrupts of a PCI device.
void add_numbers(const fs::path& device, Marks& marks) {
  std::error_code missing;
  for (const auto& number : fs::directory_iterator(device / "msi_irqs", missing)) {
    marks.numbers.insert(std::atoi(number.path().filename().c_str()));
  }
  if (const int number = std::atoi(first_line(device / "irq").c_str()); number > 0) {
    marks.numbers.insert(number);
  }
}

/// The controller of the USB bus that a device is on: the folder above "usb1".
fs::path usb_host(fs::path device) {
  while (device.has_relative_path() && !device.filename().string().starts_with("usb")) {
    device = device.parent_path();
  }
  return device.parent_path();
}

/// @param device  the folder of the adapter in /sys/devices
Marks marks_of(const std::string& bus, const fs::path& device, const std::string& subsystem) {
  Marks marks;
  marks.names = {bus};
  add_numbers(device, marks);
  if (subsystem == "spi") {
    marks.names.push_back(device.filename());
    marks.names.push_back(device.parent_path().parent_path().parent_path().filename());
  }
  if (subsystem == "usb") {
    const fs::path host = usb_host(device);
    add_numbers(host, marks);
    for (const char* name : {"xhci", "ehci", "ohci", "uhci", "dwc", "musb"}) marks.names.push_back(name);
    if (host.has_filename()) marks.names.push_back(host.filename());
    marks.softirq = true;
  }
  return marks;
}

/// Whether what a thread serves has this name, or one that goes on behind it where no digit follows.
bool is_called(std::string_view served, std::string_view name, bool cut_off) {
  if (cut_off && served.size() < name.size()) return served.size() > 3 && name.starts_with(served);
  if (!served.starts_with(name)) return false;
  const std::string_view rest = served.substr(name.size());
  return rest.empty() || rest[0] < '0' || rest[0] > '9';
}

bool serves(const InterruptThread& thread, const std::string& bus, const Marks& marks) {
  if (thread.name.starts_with("ksoftirqd/")) return marks.softirq;
  if (thread.name.starts_with("napi/")) return thread.name.starts_with("napi/" + bus + "-");
  if (marks.numbers.contains(std::atoi(thread.name.c_str() + std::string_view("irq/").size()))) return true;
  const std::size_t dash = thread.name.find('-');
  if (dash == std::string::npos) return false;
  std::string_view served = std::string_view(thread.name).substr(dash + 1);
  if (served.starts_with("s-")) served.remove_prefix(2);  // a thread beside the first
  return std::ranges::any_of(marks.names, [&](const std::string& name) {
    return is_called(served, name, thread.name.size() >= kLongestName);
  });
}

/// Where /sys describes the adapter of a bus: a network interface, or a serial port by any of its names.
fs::path device_link(const std::string& bus, const std::string& root) {
  constexpr std::string_view kAtPort = "fdcanusb:";
  if (!bus.starts_with(kAtPort)) return root + "/sys/class/net/" + bus + "/device";
  std::error_code missing;
  const fs::path port = fs::canonical(root + bus.substr(kAtPort.size()), missing);
  return root + "/sys/class/tty/" + port.filename().string() + "/device";
}

}  // namespace

std::vector<BusInterrupts> bus_interrupts(std::span<const std::string> buses, const std::string& root) {
  const std::vector<InterruptThread> threads = interrupt_threads(root);
  std::vector<BusInterrupts> found;
  for (const std::string& bus : buses) {
    BusInterrupts& of_bus = found.emplace_back(bus, "", std::vector<InterruptThread>{});
    std::error_code missing;
    const fs::path device = fs::canonical(device_link(bus, root), missing);
    if (missing) continue;
    const std::string subsystem = fs::canonical(device / "subsystem", missing).filename();
    of_bus.adapter.append(subsystem == "usb" ? "usb " : "").append(device.filename().string());
    const Marks marks = marks_of(bus, device, subsystem);
    std::ranges::copy_if(threads, std::back_inserter(of_bus.threads),
                         [&](const InterruptThread& thread) { return serves(thread, bus, marks); });
  }
  return found;
}

}  // namespace stilt::realtime
