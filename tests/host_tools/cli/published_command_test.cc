#include "host_tools/cli/published_command.h"

#include <gtest/gtest.h>

namespace stilt::cli {
namespace {

TEST(PublishedCommand, KeepsWhatDecidesTheFiguresAlone) {
  EXPECT_EQ(published_command({"build/release/bin/stilt", "experiment", "disturbance", "--rows",
                               "docs/results/pushes.toml", "--out", "/tmp/pushes", "--json", "pushes.json",
                               "--processes", "2", "--set", "cost.terminal=2", "--merge"}),
            "stilt experiment disturbance --rows docs/results/pushes.toml --out DIR --set cost.terminal=2");
  EXPECT_EQ(published_command({"stilt", "experiment", "limits", "--out=/tmp/limits", "--json=-", "--quick"}),
            "stilt experiment limits --out DIR --quick");
}

}  // namespace
}  // namespace stilt::cli
