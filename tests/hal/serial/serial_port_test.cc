#include "hal/serial/serial_port.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/own_folder.h"
#include "tests/pseudo_terminal.h"

namespace stilt::hal::serial {
namespace {

constexpr std::int64_t kLongest_ns = 20'000'000'000;  // a bound for hanging

/// Reads until so many bytes came.
std::vector<std::uint8_t> bytes_of(const SerialPort& port, std::size_t count) {
  std::vector<std::uint8_t> all;
  while (all.size() < count && port.wait(kLongest_ns)) {
    std::uint8_t part[64];
    const std::ptrdiff_t read = port.read(part);
    if (read < 0) break;
    all.insert(all.end(), part, part + read);
  }
  return all;
}

TEST(SerialPort, EveryByteArrivesAsItWasSent) {
  const tests::PseudoTerminal terminal;
  auto port = SerialPort::open(terminal.port(), 115200);
  ASSERT_TRUE(port) << port.error();
  std::vector<std::uint8_t> sent(256);
  for (std::size_t i = 0; i < sent.size(); ++i)
    sent[i] = static_cast<std::uint8_t>(i);  // also ^C, ^S, CR, DEL
  terminal.write(sent);
  EXPECT_EQ(bytes_of(*port, sent.size()), sent);
}

TEST(SerialPort, NothingIsReadWhereNothingWaits) {
  const tests::PseudoTerminal terminal;
  auto port = SerialPort::open(terminal.port(), 921600);
  ASSERT_TRUE(port);
  EXPECT_FALSE(port->wait(0));
  std::uint8_t byte = 0;
  EXPECT_EQ(port->read(std::span(&byte, 1)), 0);
}

TEST(SerialPort, APortThatIsGoneIsReadableAndGivesNothing) {
  tests::PseudoTerminal terminal;
  auto port = SerialPort::open(terminal.port(), 921600);
  ASSERT_TRUE(port);
  terminal.hang_up();
  EXPECT_TRUE(port->wait(kLongest_ns));
  std::uint8_t byte = 0;
  EXPECT_LE(port->read(std::span(&byte, 1)), 0);
}

TEST(SerialPort, WhatIsWrittenArrivesAtTheOtherEnd) {
  tests::PseudoTerminal terminal;
  auto port = SerialPort::open(terminal.port(), 115200, Access::read_write);
  ASSERT_TRUE(port) << port.error();
  const std::string text = "can status\n";
  EXPECT_EQ(port->write(text), static_cast<std::ptrdiff_t>(text.size()));
  constexpr int kLongest_ms = 20'000;  // a bound for hanging
  EXPECT_EQ(terminal.read(kLongest_ms), text) << "and no character more at the end of a line";
  terminal.hang_up();
  EXPECT_EQ(port->write(text), -1);
}

TEST(SerialPort, APortThatIsFullTakesNothing) {
  const tests::PseudoTerminal terminal;
  auto port = SerialPort::open(terminal.port(), 115200, Access::read_write);
  ASSERT_TRUE(port);
  const std::string text(1000, 'a');
  while (port->write(text) > 0) {
  }
  EXPECT_EQ(port->write(text), 0);
}

TEST(SerialPort, APortToWriteBelongsToOneProgram) {
  const tests::PseudoTerminal terminal;
  const auto first = SerialPort::open(terminal.port(), 115200, Access::read_write);
  ASSERT_TRUE(first);
  const auto second = SerialPort::open(terminal.port(), 115200, Access::read_write);
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().find("another program has it"), std::string::npos) << second.error();
}

TEST(SerialPort, WhatCannotBeOpenedIsNamed) {
  const auto error = [](const std::string& path, int rate) { return SerialPort::open(path, rate).error(); };
  EXPECT_EQ(error("/nowhere/ttyUSB0", 115200),
            "serial port /nowhere/ttyUSB0: cannot be opened (No such file or directory); see "
            "torso_sensor.serial_port, ls /dev/ttyUSB* /dev/ttyACM* /dev/ttyS*");
  EXPECT_EQ(error("/dev/null", 1234), "serial port /dev/null: no port has 1234 bit/s");
  const tests::OwnFolder folder;
  std::ofstream(folder.file("file")) << "no terminal";
  EXPECT_NE(error(folder.file("file"), 115200).find("is it a serial port?"), std::string::npos);
}

}  // namespace
}  // namespace stilt::hal::serial
