#include "firmware/configuration/live.h"

#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>

#include "firmware/diagnostics/input_file.h"

namespace stilt::configuration {
namespace {

TEST(LiveTunables, AreThoseOfTheDocument) {
  const std::string page = diagnostics::read_file(TUNING).value();
  const std::size_t from = page.find("\n## Live tunables\n");
  ASSERT_NE(from, std::string::npos);
  const std::string list = page.substr(from, page.find("\n## ", from + 1) - from);
  std::set<std::string> named, live;
  const std::regex key("`([a-z_]+\\.\\w+)`");
  for (std::sregex_iterator found(list.begin(), list.end(), key); found != std::sregex_iterator(); ++found) {
    EXPECT_TRUE(named.insert((*found)[1]).second) << (*found)[1];
  }
  for (const LiveTunable& tunable : live_tunables({})) live.insert(tunable.entry->name());
  EXPECT_EQ(named, live);
}

}  // namespace
}  // namespace stilt::configuration
