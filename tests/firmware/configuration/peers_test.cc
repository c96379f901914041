#include "firmware/configuration/peers.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "firmware/configuration/configuration.h"

namespace stilt::configuration {
namespace {

TEST(Peers, AreIPv4AddressesAndHostNamesWithOrWithoutAPort) {
  for (const std::string& list :
       {std::string("192.168.1.20"), std::string("192.168.1.20:7410"), std::string("robot"),
        std::string("no-such-host.invalid:65535"), std::string("10.0.0.1, 10.0.0.2 ,, 3com.com"),
        std::string("none"), std::string(63, 'a') + "." + std::string(63, 'b')}) {
    EXPECT_EQ(peers_mistake(list), std::nullopt) << list;
  }
}

TEST(Peers, AnEntryThatCannotBeIsRefusedWithItsName) {
  for (const std::string& entry :
       {std::string("300.1.1.1"),
        std::string("192.168.1"),
        std::string("7"),
        std::string("10.0.0.1.2"),
        std::string("fe80::1"),
        std::string("foo_bar"),
        std::string("a\"b"),
        std::string("a<b"),
        std::string("a b"),
        std::string("a..b"),
        std::string(".a"),
        std::string("a."),
        std::string("-a"),
        std::string("a-"),
        std::string("udp/10.0.0.1"),
        std::string("10.0.0.1:"),
        std::string("10.0.0.1:0"),
        std::string("10.0.0.1:65536"),
        std::string("10.0.0.1:123456"),
        std::string("10.0.0.1:7410:7411"),
        std::string("a:b"),
        std::string(":7410"),
        std::string(64, 'a'),
        std::string(250, 'a').replace(62, 1, ".").replace(125, 1, ".").replace(188, 1, ".") + ".abc"}) {
    EXPECT_EQ(peers_mistake("10.0.0.1, " + entry + " ,robot"),
              "\"" + entry +
                  "\" is neither an IPv4 address nor a host name; give both with commas between, such as "
                  "192.168.1.20,robot.local");
  }
}

TEST(Peers, TheConfigurationRefusesThemAtTheirLine) {
  const auto result = parse("[telemetry]\npeers = \"300.1.1.1\"\n", "robot.toml");
  ASSERT_FALSE(result);
  EXPECT_TRUE(
      to_string(result.error()).starts_with("robot.toml:2:9: telemetry.peers: \"300.1.1.1\" is neither"))
      << to_string(result.error());
  EXPECT_TRUE(parse("[telemetry]\npeers = \"robot.local\"\n", "robot.toml"));
}

}  // namespace
}  // namespace stilt::configuration
