#include "host_tools/simulation/robot_on_bus/frame_log.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/own_folder.h"

namespace stilt::robot_on_bus {
namespace {

hal::CanFrame frame(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  hal::CanFrame result = hal::classic_frame(id, static_cast<std::uint8_t>(bytes.size()));
  std::ranges::copy(bytes, result.data.begin());
  return result;
}

TEST(FrameLog, FramesReadAsCanUtilsWritesThem) {
  EXPECT_EQ(frame_text(frame(0x11, {0x01, 0xab})), "011#01AB");
  hal::CanFrame extended = frame(0x11, {0x01});
  extended.extended = true;
  EXPECT_EQ(frame_text(extended), "00000011#01");
  hal::CanFrame remote = frame(0x11, {});
  remote.remote = true;
  EXPECT_EQ(frame_text(remote), "011#R");
  hal::CanFrame flexible = frame(0x11, {0x01});
  flexible.fd = true;
  EXPECT_EQ(frame_text(flexible), "011##001");
  flexible.bit_rate_switch = true;
  EXPECT_EQ(frame_text(flexible), "011##101");
  hal::CanFrame error = frame(0x40, {0});
  error.error = true;
  EXPECT_EQ(frame_text(error), "20000040#00");
}

TEST(FrameLog, ALineHasTickBusAndSender) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("frames");
  FrameLog log(file);
  log.write(7, 1, FrameLog::Sender::controller, frame(1, {0xff}));
  log.write(8, 0, FrameLog::Sender::robot, frame(0x11, {}));
  log.close();
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  EXPECT_EQ(text.str(), "7 1 controller 001#FF\n8 0 robot 011#\n");
}

TEST(FrameLog, WithoutANameNothingIsWritten) {
  const std::filesystem::path before = std::filesystem::current_path();
  const tests::OwnFolder folder;
  std::filesystem::current_path(folder.path());  // where a file with any relative name would appear
  FrameLog log("");
  log.write(1, 0, FrameLog::Sender::robot, frame(1, {}));
  log.close();
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  std::filesystem::current_path(before);
}

TEST(FrameLog, AFileThatCannotBeMadeOrFilledIsReportedByName) {
  EXPECT_THROW(FrameLog("/nowhere/at/all"), std::runtime_error);
  FrameLog log("/dev/full");
  log.write(1, 0, FrameLog::Sender::robot, frame(1, {}));
  try {
    log.close();
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("--frames /dev/full"), std::string::npos);
  }
}

}  // namespace
}  // namespace stilt::robot_on_bus
