#include "firmware/program/service_manager.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <string>

#include "tests/own_folder.h"

namespace stilt::program {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// The other end of $NOTIFY_SOCKET.
class Listener : public testing::Test {
 protected:
  Listener() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path_.c_str(), 1);
  }
  ~Listener() override {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    close(socket_);
  }

  /// What was said since the last call.
  std::string received() const {
    std::string text;
    char message[512];
    for (ssize_t size = 0; (size = recv(socket_, message, sizeof message, 0)) > 0;) {
      text.append(message, static_cast<std::size_t>(size));
    }
    return text;
  }

 private:
  tests::OwnFolder folder_;
  std::string path_ = folder_.file("notify");
  int socket_ = -1;
};

TEST_F(Listener, ReceivesReadyOnceTheTorqueLoopTicks) {
  ServiceManager service({});
  service.notify(kSecond_ns, 0, "boot");
  EXPECT_EQ(received(), "STATUS=boot\n");
  service.notify(2 * kSecond_ns, 250, "idle");
  EXPECT_EQ(received(), "READY=1\nWATCHDOG=1\nSTATUS=idle\n");
}

TEST_F(Listener, ReceivesSignsOfLifeOnlyWhileTheTorqueLoopTicks) {
  ServiceManager service({});
  service.notify(kSecond_ns, 250, "walk");
  received();
  service.notify(kSecond_ns + kSecond_ns / 4, 500, "walk");
  EXPECT_EQ(received(), "") << "not at every turn";
  service.notify(2 * kSecond_ns, 1000, "walk");
  EXPECT_EQ(received(), "WATCHDOG=1\n");
  service.notify(3 * kSecond_ns, 1000, "walk");
  EXPECT_EQ(received(), "") << "it stands still";
}

TEST_F(Listener, ReceivesAWatchdogThatWaitsUntilARobotWithoutHousekeepingHasSatDown) {
  supervisor::SupervisorParameters parameters;
  parameters.operator_gone_s = 30.0;
  parameters.slow_down_s = 1.5;
  parameters.sit_s = 2.0;
  parameters.damped_before_off_s = 3.0;
  setenv("WATCHDOG_USEC", "10000000", 1);
  ServiceManager(parameters).notify(kSecond_ns, 250, "idle");
  EXPECT_EQ(received(), "READY=1\nWATCHDOG_USEC=43000000\nWATCHDOG=1\nSTATUS=idle\n") << "and 5 s to spare";
  setenv("WATCHDOG_USEC", "60000000", 1);
  ServiceManager(parameters).notify(kSecond_ns, 250, "idle");
  EXPECT_EQ(received(), "READY=1\nWATCHDOG=1\nSTATUS=idle\n") << "it waits longer anyway";
}

TEST_F(Listener, ReceivesTheEnd) {
  ServiceManager({}).notify_stopping();
  EXPECT_EQ(received(), "STOPPING=1");
}

TEST_F(Listener, ReceivesOnceHowLongTheRobotMayNeedToSitDown) {
  supervisor::SupervisorParameters parameters;
  parameters.slow_down_s = 6.0;
  parameters.sit_s = 20.0;
  parameters.damped_before_off_s = 10.0;
  ServiceManager service(parameters);
  service.notify_stop_asked();
  EXPECT_EQ(received(), "EXTEND_TIMEOUT_USEC=47000000") << "2 * 6 s + 20 s + 10 s, and 5 s to spare";
  service.notify_stop_asked();
  EXPECT_EQ(received(), "");
}

}  // namespace
}  // namespace stilt::program
