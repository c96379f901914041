// Serves the monitor's page for a synthetic robot, for tests in a browser. Prints the address; standard input
// takes words for SyntheticSource::change(), a line each; ends with it. Its arguments are addresses that the
// page offers to others.

#include <poll.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <string>
#include <thread>

#include "host_tools/web/monitor/live_view.h"
#include "host_tools/web/monitor/monitor_page.h"
#include "synthetic_source.h"

namespace {

constexpr const char* kKey = "key-of-a-test";

bool line_waits() {
  pollfd input{0, POLLIN, 0};
  return ::poll(&input, 1, 0) > 0;
}

}  // namespace

int main(int count, char** addresses) {
  using namespace stilt::monitor;
  std::setvbuf(stdin, nullptr, _IONBF, 0);  // no line may hide in a buffer from poll()
  SyntheticSource source;
  LiveView view(source, kKey);
  view.set_urls({addresses + 1, addresses + count});
  WebServer server({"127.0.0.1", 0});
  server.serve_page(kMonitorPage);
  server.add_endpoint({"/live", {}, {}}, view);
  server.start();
  std::printf("%s#key=%s\n", server.url().c_str(), kKey);
  std::fflush(stdout);
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    const double now_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    source.advance(now_s);
    view.step(now_s);
    while (line_waits()) {
      std::string words;
      if (!std::getline(std::cin, words)) return 0;
      source.change(words);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}
