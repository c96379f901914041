#include "host_tools/web/monitor/serve.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <string>
#include <thread>

#include "firmware/telemetry/secret.h"
#include "host_tools/web/monitor/live_view.h"
#include "host_tools/web/monitor/monitor_page.h"

extern char** environ;

namespace stilt::monitor {
namespace {

/// A page of this user alone that leads to an address. The address itself, with its key, would be among the
/// words of the browser's process, which every user of the machine may read.
class LinkFile {
 public:
  explicit LinkFile(const std::string& url) {
    const char* runtime = std::getenv("XDG_RUNTIME_DIR");
    path_ = std::string(runtime != nullptr ? runtime : "/tmp") + "/stilt-monitor-XXXXXX.html";
    constexpr int kSuffix = 5;
    const int file = mkostemps(path_.data(), kSuffix, O_CLOEXEC);  // readable by its owner alone
    if (file < 0) return;
    const std::string page = "<meta http-equiv=\"refresh\" content=\"0; url=" + url + "\">\n";
    written_ = write(file, page.data(), page.size()) == std::ssize(page);
    close(file);
  }
  ~LinkFile() {
    if (written_) unlink(path_.c_str());
  }
  LinkFile(const LinkFile&) = delete;
  LinkFile& operator=(const LinkFile&) = delete;

  /// Opens it on the desktop; no effect without a desktop.
  void open() {
    if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
    std::string program = "xdg-open";
    char* argv[] = {program.data(), path_.data(), nullptr};
    posix_spawn_file_actions_t without_sockets;  // a browser that held them would keep the port in use
    posix_spawn_file_actions_init(&without_sockets);
    posix_spawn_file_actions_addclosefrom_np(&without_sockets, STDERR_FILENO + 1);
    pid_t process = 0;
    const bool opened = written_ && posix_spawnp(&process, "xdg-open", &without_sockets, nullptr,
                                                 static_cast<char**>(argv), environ) == 0;
    posix_spawn_file_actions_destroy(&without_sockets);
    if (!opened) return;
    std::thread([process] { waitpid(process, nullptr, 0); }).detach();
  }

 private:
  std::string path_;
  bool written_ = false;
};

}  // namespace

void serve(SampleSource& source, const ServeOptions& options) {
  constexpr auto kStep = std::chrono::milliseconds(10);
  // Who has this key may use the tokens that the source has. It is valid as long as this process runs.
  const std::string key = source.live() ? telemetry::random_secret() : std::string();
  const std::string fragment = key.empty() ? std::string() : "#key=" + key;
  LiveView view(source, key);
  WebServer server(options.server);
  view.set_urls(server.urls_for_others());
  server.serve_page(kMonitorPage);
  server.add_endpoint({"/live", {}, {}}, view);
  options.extend(server);
  server.start();
  std::printf("monitor: %s%s\n", server.url().c_str(), fragment.c_str());
  for (const std::string& url : server.urls_for_others()) {
    std::printf("from another machine: %s%s\n", url.c_str(), fragment.c_str());
  }
  std::fflush(stdout);
  std::optional<LinkFile> link;
  if (options.open_browser) link.emplace(server.url() + fragment).open();
  const auto start = std::chrono::steady_clock::now();
  while (options.stop == nullptr || !options.stop->load()) {
    view.step(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    std::this_thread::sleep_for(kStep);
  }
}

}  // namespace stilt::monitor
