#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <unistd.h>

#include <array>
#include <string>
#include <thread>
#include <vector>

#include "hal/any_bus.h"
#include "hal/loopback/loopback_client.h"
#include "hal/loopback/loopback_server.h"

namespace stilt::hal::loopback {
namespace {

/// A name no other test process uses at the same time.
std::string unique_name(const char* test) { return std::string(test) + "." + std::to_string(::getpid()); }

std::vector<CanFrame> receive_all(FrameBus& bus) {
  std::array<CanFrame, kMaximumBatch> frames;
  std::vector<CanFrame> all;
  while (true) {
    const ReceiveResult result = bus.receive(frames);
    all.insert(all.end(), frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(result.received));
    if (result.status != BusStatus::more) return all;
  }
}

/// Connects without a second thread: the robot looks after its bus between two attempts of the controller.
Connection connect(LoopbackClient& client, LoopbackServer& server, const std::string& name) {
  static_cast<void>(client.open(name, 0));  // remembers the name; too short a wait to be greeted
  Connection state = client.reconnect();
  for (int i = 0; i < 3 && state == Connection::waiting; ++i) {
    static_cast<void>(receive_all(server));
    state = client.reconnect();
  }
  return state;
}

TEST(Loopback, FramesGoBothWaysAndCommandsAreConfirmed) {
  const std::string name = unique_name("both-ways");
  LoopbackServer server;
  ASSERT_TRUE(server.open(name));
  LoopbackClient client;
  ASSERT_EQ(connect(client, server, name), Connection::connected);
  const std::vector<CanFrame> commands{classic_frame(1, 8), classic_frame(2, 8)};
  ASSERT_EQ(client.frames().send(commands).status, BusStatus::ok);
  EXPECT_EQ(client.frames().send(commands).status, BusStatus::unconfirmed);
  EXPECT_EQ(receive_all(server), commands);
  CanFrame reply;
  reply.id = 0x100;
  reply.fd = true;
  reply.length = 20;
  ASSERT_EQ(server.send(std::span(&reply, 1)).sent, 1u);
  EXPECT_EQ(receive_all(client.frames()), std::vector<CanFrame>{reply});
  EXPECT_EQ(client.frames().counters().confirmed, 2u);
  EXPECT_EQ(client.frames().send(commands).status, BusStatus::ok);
}

TEST(Loopback, AControllerThatWasHungUpOnComesBack) {
  const std::string name = unique_name("hung-up");
  LoopbackServer server;
  ASSERT_TRUE(server.open(name));
  LoopbackClient client;
  ASSERT_EQ(connect(client, server, name), Connection::connected);
  const std::uint64_t before = server.connections();
  server.hang_up();
  EXPECT_FALSE(server.connected());
  static_cast<void>(receive_all(client.frames()));
  EXPECT_FALSE(client.frames().connected());
  Connection state = client.reconnect();
  for (int i = 0; i < 3 && state == Connection::waiting; ++i) {
    static_cast<void>(receive_all(server));
    state = client.reconnect();
  }
  EXPECT_EQ(state, Connection::connected);
  EXPECT_EQ(server.connections(), before + 1);
}

TEST(Loopback, OpenWaitsForTheGreeting) {
  const std::string name = unique_name("greeting");
  LoopbackServer server;
  ASSERT_TRUE(server.open(name));
  std::thread robot([&server] {
    while (!server.connected()) static_cast<void>(receive_all(server));
  });
  AnyBus bus;
  const auto opened = bus.open("loopback:" + name, {});
  robot.join();
  EXPECT_TRUE(opened) << opened.error();
}

TEST(Loopback, ASocketWithoutAListenerIsReportedInOneSentence) {
  AnyBus bus;
  const auto opened = bus.open("loopback:absent-here", {});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error(),
            "bus loopback:absent-here: no program listens there; start `stilt robot --bus "
            "loopback:absent-here` first");
}

TEST(Loopback, ARobotThatDoesNotAnswerIsSaidInOneSentence) {
  const std::string name = unique_name("deaf");
  LoopbackServer server;
  ASSERT_TRUE(server.open(name));
  LoopbackClient client;
  const auto opened = client.open(name, 0);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error(), "bus loopback:" + name + ": the robot listens but does not answer");
}

TEST(Loopback, ASecondControllerIsRefusedAndTheFirstKeepsTheBus) {
  const std::string name = unique_name("second");
  LoopbackServer server;
  ASSERT_TRUE(server.open(name));
  LoopbackClient first;
  ASSERT_EQ(connect(first, server, name), Connection::connected);
  LoopbackClient second;
  EXPECT_EQ(connect(second, server, name), Connection::busy);
  EXPECT_GE(server.refused(), 1u);
  const CanFrame frame = classic_frame(1, 8);
  EXPECT_EQ(second.frames().send(std::span(&frame, 1)).status, BusStatus::disconnected);
  EXPECT_EQ(first.frames().send(std::span(&frame, 1)).status, BusStatus::ok);
}

TEST(Loopback, TheControllerFindsARestartedRobot) {
  const std::string name = unique_name("robot-restarts");
  LoopbackClient client;
  {
    LoopbackServer server;
    ASSERT_TRUE(server.open(name));
    ASSERT_EQ(connect(client, server, name), Connection::connected);
  }
  std::array<CanFrame, 1> frames;
  EXPECT_EQ(client.frames().receive(frames).status, BusStatus::disconnected);
  EXPECT_EQ(client.reconnect(), Connection::no_listener);
  LoopbackServer restarted;
  ASSERT_TRUE(restarted.open(name));
  EXPECT_EQ(client.reconnect(), Connection::waiting);
  static_cast<void>(receive_all(restarted));
  EXPECT_EQ(client.reconnect(), Connection::connected);
  const CanFrame frame = classic_frame(1, 8);
  EXPECT_EQ(client.frames().send(std::span(&frame, 1)).status, BusStatus::ok);
  EXPECT_EQ(receive_all(restarted).size(), 1u);
}

TEST(Loopback, TheRobotServesTheNextControllerAfterOneHasDied) {
  const std::string name = unique_name("controller-dies");
  LoopbackServer server;
  ASSERT_TRUE(server.open(name));
  {
    LoopbackClient client;
    ASSERT_EQ(connect(client, server, name), Connection::connected);
  }
  std::array<CanFrame, 1> frames;
  EXPECT_EQ(server.receive(frames).status, BusStatus::disconnected);
  EXPECT_EQ(server.send(frames).status, BusStatus::disconnected);
  LoopbackClient next;
  EXPECT_EQ(connect(next, server, name), Connection::connected);
  EXPECT_TRUE(server.connected());
}

/// A batch of its frames is read before its end shows as the end of the connection.
TEST(Loopback, TheNextControllerIsNotRefusedWhileTheLastFramesOfADeadOneWait) {
  const std::string name = unique_name("last-frames");
  LoopbackServer server;
  ASSERT_TRUE(server.open(name));
  std::vector<CanFrame> last;
  for (std::uint32_t id = 1; id <= kMaximumBatch; ++id) last.push_back(classic_frame(id, 8));
  {
    LoopbackClient first;
    ASSERT_EQ(connect(first, server, name), Connection::connected);
    ASSERT_EQ(first.frames().send(last).sent, last.size());
  }
  LoopbackClient second;
  EXPECT_EQ(connect(second, server, name), Connection::connected);
  EXPECT_EQ(server.refused(), 0u);
}

TEST(Loopback, TwoRobotsCannotShareAName) {
  const std::string name = unique_name("shared");
  LoopbackServer first;
  ASSERT_TRUE(first.open(name));
  LoopbackServer second;
  const auto opened = second.open(name);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error(), "bus loopback:" + name + ": another robot listens at this name");
}

TEST(Loopback, ASilentRobotGetsOneCommandPerJointWhenItWakes) {
  const std::string name = unique_name("silent");
  LoopbackServer server;
  ASSERT_TRUE(server.open(name));
  LoopbackClient client;
  ASSERT_EQ(connect(client, server, name), Connection::connected);
  const CanFrame command = classic_frame(1, 8);
  for (int tick = 0; tick < 100; ++tick) static_cast<void>(client.frames().send(std::span(&command, 1)));
  EXPECT_EQ(receive_all(server).size(), 1u) << "a stopped process cannot be flooded either";
}

TEST(Loopback, ErrorFramesOfTheRobotReachTheControllersHealth) {
  const std::string name = unique_name("bus-off");
  LoopbackServer server;
  ASSERT_TRUE(server.open(name));
  LoopbackClient client;
  ASSERT_EQ(connect(client, server, name), Connection::connected);
  CanFrame off;
  off.error = true;
  off.id = CAN_ERR_BUSOFF;
  off.length = 8;
  ASSERT_EQ(server.send(std::span(&off, 1)).sent, 1u);
  EXPECT_TRUE(receive_all(client.frames()).empty());
  EXPECT_EQ(client.frames().health(), BusHealth::off);
}

TEST(Loopback, NamesAreLettersDigitsAndAFewSigns) {
  EXPECT_TRUE(valid_name("robot-1.left_leg"));
  EXPECT_FALSE(valid_name(""));
  EXPECT_FALSE(valid_name("a/b"));
  EXPECT_FALSE(valid_name(std::string(65, 'a')));
  LoopbackServer server;
  EXPECT_FALSE(server.open("a b"));
}

}  // namespace
}  // namespace stilt::hal::loopback
