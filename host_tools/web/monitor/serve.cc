#include "host_tools/web/monitor/serve.h"

#include <spawn.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "host_tools/web/monitor/live_view.h"
#include "host_tools/web/monitor/monitor_page.h"

extern char** environ;

namespace stilt::monitor {
namespace {

/// Opens the page on the desktop; no effect without a desktop.
void open_in_browser(const std::string& url) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  std::string program = "xdg-open";
  std::string address = url;
  char* argv[] = {program.data(), address.data(), nullptr};
  pid_t process = 0;
  if (posix_spawnp(&process, "xdg-open", nullptr, nullptr, static_cast<char**>(argv), environ) != 0) return;
  std::thread([process] { waitpid(process, nullptr, 0); }).detach();
}

}  // namespace

void serve(SampleSource& source, const ServeOptions& options) {
  constexpr auto kStep = std::chrono::milliseconds(10);
  LiveView view(source);
  WebServer server(options.server);
  server.serve_page(kMonitorPage);
  server.add_endpoint({"/live", {}, {}}, view);
  options.extend(server);
  std::printf("monitor: %s\n", server.url().c_str());
  std::fflush(stdout);
  if (options.open_browser) open_in_browser(server.url());
  const auto start = std::chrono::steady_clock::now();
  while (options.stop == nullptr || !options.stop->load()) {
    view.step(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    std::this_thread::sleep_for(kStep);
  }
}

}  // namespace stilt::monitor
