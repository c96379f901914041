#include "host_tools/web/monitor/serve.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "silent_source.h"
#include "tests/own_folder.h"

namespace stilt::monitor {
namespace {

/// The browser is a script that lists what it has open beyond its standard streams, and the page it is given.
TEST(Serve, ABrowserGetsAPageOfThisUserAloneAndNoSocket) {
  const tests::OwnFolder folder;
  const std::string program = folder.file("xdg-open"), seen = folder.file("seen");
  std::ofstream(program) << "#!/bin/sh\nfor file in /proc/$$/fd/*; do\n"
                            "  [ \"${file##*/}\" -le 2 ] || readlink \"$file\"\ndone >"
                         << seen << ".part\nstat -c 'mode %a' \"$1\" >>" << seen << ".part\ncat \"$1\" >>"
                         << seen << ".part\nmv " << seen << ".part " << seen << "\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const std::string path = std::getenv("PATH");
  setenv("PATH", (folder.path().string() + ":" + path).c_str(), 1);
  setenv("DISPLAY", ":0", 1);
  setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1);
  SilentSource source;
  std::atomic<bool> stop = false;
  std::thread server([&] { serve(source, {.server = {.port = 0}, .open_browser = true, .stop = &stop}); });
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!std::filesystem::exists(seen) && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  stop = true;
  server.join();
  setenv("PATH", path.c_str(), 1);
  unsetenv("DISPLAY");
  unsetenv("XDG_RUNTIME_DIR");
  std::ifstream file(seen);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(text.find("socket"), std::string::npos) << text;
  EXPECT_NE(text.find("mode 600\n"), std::string::npos) << text;
  EXPECT_NE(text.find("/#key="), std::string::npos) << text;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    EXPECT_EQ(entry.path().filename().string().find("stilt-monitor-"), std::string::npos)
        << "removed at the end";
  }
}

}  // namespace
}  // namespace stilt::monitor
