#include "firmware/realtime/bus_interrupts.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/own_folder.h"

namespace stilt::realtime {
namespace {

namespace fs = std::filesystem;

/// A machine's /sys and /proc under a folder of its own.
class BusInterruptsTest : public testing::Test {
 protected:
  /// @param path  of the adapter under /sys/devices
  void adapter(const std::string& bus, const std::string& path, const std::string& subsystem,
               const std::string& kind = "net") {
    const fs::path device = root_ + "/sys/devices/" + path;
    const fs::path of_kind = root_ + "/sys/bus/" + subsystem;
    fs::create_directories(device);
    fs::create_directories(of_kind);
    fs::create_directory_symlink(of_kind, device / "subsystem");
    const std::string of_class = root_ + "/sys/class/" + kind + "/" + bus;
    fs::create_directories(of_class);
    fs::create_directory_symlink(device, of_class + "/device");
  }
  void write(const std::string& path, const std::string& text) {
    fs::create_directories(fs::path(root_ + path).parent_path());
    std::ofstream(root_ + path) << text << '\n';
  }
  void thread(const std::string& name) { write("/proc/" + std::to_string(100 + threads_++) + "/comm", name); }
  /// Names of the threads that serve a bus, each followed by a blank.
  [[nodiscard]] std::string serving(const std::string& bus) const {
    std::string names;
    const std::string buses[] = {bus};
    const std::vector<BusInterrupts> all = bus_interrupts(buses, root_);
    for (const InterruptThread& found : all.at(0).threads) names += found.name + " ";
    return names;
  }
  [[nodiscard]] std::string adapter_of(const std::string& bus) const {
    const std::string buses[] = {bus};
    return bus_interrupts(buses, root_).at(0).adapter;
  }
  tests::OwnFolder folder_;
  std::string root_ = folder_.path().string();
  int threads_ = 0;
};

TEST_F(BusInterruptsTest, AControllerOfTheComputerIsKnownByTheNameOfTheBus) {
  adapter("can1", "platform/fec.can", "platform");
  for (const char* name : {"irq/45-can1", "irq/46-can10", "irq/47-eth0", "ksoftirqd/0", "napi/can1-8"}) {
    thread(name);
  }
  EXPECT_EQ(adapter_of("can1"), "fec.can");
  EXPECT_EQ(serving("can1"), "irq/45-can1 napi/can1-8 ");
}

TEST_F(BusInterruptsTest, AnAdapterAtASerialPortIsKnownByAnyNameOfThePort) {
  adapter("ttyACM0", "pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.1", "usb", "tty");
  write("/dev/ttyACM0", "");
  fs::create_directories(root_ + "/dev/serial/by-id");
  fs::create_symlink(root_ + "/dev/ttyACM0", root_ + "/dev/serial/by-id/usb-mjbots_fdcanusb_0123ABCD-if00");
  for (const char* name : {"irq/30-xhci_hcd", "irq/45-can1", "ksoftirqd/0"}) thread(name);
  const std::string bus = "fdcanusb:/dev/serial/by-id/usb-mjbots_fdcanusb_0123ABCD-if00";
  EXPECT_EQ(adapter_of(bus), "usb 1-2:1.1");
  EXPECT_EQ(serving(bus), "irq/30-xhci_hcd ksoftirqd/0 ");
  EXPECT_EQ(adapter_of("fdcanusb:/dev/ttyACM1"), "");
}

TEST_F(BusInterruptsTest, AnSpiDeviceIsKnownByItsNameAndItsController) {
  adapter("can0", "platform/soc/fe204000.spi/spi_master/spi0/spi0.1", "spi");
  for (const char* name :
       {"irq/55-spi0.1", "irq/56-spi0.0", "irq/39-fe204000", "irq/160-s-spi0.", "irq/40-fe205000.spi"}) {
    thread(name);
  }
  EXPECT_EQ(adapter_of("can0"), "spi0.1");
  EXPECT_EQ(serving("can0"), "irq/55-spi0.1 irq/39-fe204000 irq/160-s-spi0. ")
      << "the kernel cuts names off at 15 characters";
}

TEST_F(BusInterruptsTest, AUsbAdapterIsServedByItsHostAndKsoftirqd) {
  adapter("can0", "pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.0", "usb");
  write("/sys/devices/pci0000:00/0000:00:14.0/msi_irqs/128", "msi");
  for (const char* name : {"irq/128-xhci_hcd", "irq/129-nvme0q0", "ksoftirqd/0", "irq/16-ehci_hcd:u"}) {
    thread(name);
  }
  EXPECT_EQ(adapter_of("can0"), "usb 1-2:1.0");
  EXPECT_EQ(serving("can0"), "irq/128-xhci_hcd ksoftirqd/0 irq/16-ehci_hcd:u ");
}

TEST_F(BusInterruptsTest, APciCardIsKnownByTheNumberOfItsInterrupt) {
  adapter("can0", "pci0000:00/0000:03:00.0", "pci");
  write("/sys/devices/pci0000:00/0000:03:00.0/irq", "17");
  for (const char* name : {"irq/17-peak_pciefd", "irq/18-peak_pciefd"}) thread(name);
  EXPECT_EQ(serving("can0"), "irq/17-peak_pciefd ");
}

TEST_F(BusInterruptsTest, ABusWithoutHardwareHasNeitherAdapterNorThread) {
  thread("irq/45-vcan0");
  EXPECT_EQ(adapter_of("vcan0"), "");
  EXPECT_EQ(serving("vcan0"), "");
}

}  // namespace
}  // namespace stilt::realtime
