#include "host_tools/cli/monitor_command.h"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include "firmware/telemetry/token.h"
#include "host_tools/cli/network_options.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/web/foxglove/bridge.h"
#include "host_tools/web/monitor/dds_source.h"
#include "host_tools/web/monitor/printable.h"
#include "host_tools/web/monitor/serve.h"
#include "host_tools/web/monitor/terminal_view.h"

namespace stilt::cli {
namespace {

std::atomic<bool> stop = false;

void catch_signals() {
  struct sigaction action{};
  action.sa_handler = [](int) { stop.store(true); };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

monitor::Origins viewers_of(const std::string& text) {
  if (text == "any") return {.any = true};
  monitor::Origins origins;
  if (text == "none") return origins;
  std::istringstream list(text);
  for (std::string origin; std::getline(list, origin, ',');) {
    const std::size_t scheme = origin.find("://");
    const bool whole = scheme != std::string::npos && scheme > 0 && scheme + 3 < origin.size() &&
                       origin.find_first_of("/ ", scheme + 3) == std::string::npos;
    if (!whole) {
      throw UsageError(
          "--viewers: \"" + origin +
          "\" is not a web site; write any, none, or origins such as https://app.foxglove.dev, without a "
          "path, separated by commas");
    }
    origins.named.push_back(origin);
  }
  return origins;
}

}  // namespace

CLI::App* add_monitor_command(CLI::App& program, MonitorOptions& options) {
  CLI::App* monitor = program.add_subcommand("monitor", "the live page of a running stiltd");
  monitor->add_option("--port", options.port, "port of the page; 0: any free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  monitor
      ->add_option("--bind", options.address,
                   "address of the page; on an address other than loopback, every host that reaches it "
                   "can view the page, and can command with the link or the token")
      ->capture_default_str();
  monitor->add_option("--name", options.names,
                      "host name under which the page is opened, such as that of a reverse proxy; the "
                      "addresses of this machine, its name and that in .local are known");
  monitor->add_option(
      "--token-file", options.token_file,
      "file with the token of the run, for commands; default: the file that stiltd names, when "
      "it is readable");
  monitor->add_flag("--terminal", options.terminal, "shows a summary on this terminal instead; q quits");
  monitor->add_flag("--no-browser", options.no_browser, "only prints the address");
  monitor
      ->add_option(
          "--viewers", options.viewers,
          "web sites whose pages may use the Foxglove WebSocket, which accepts no commands: any, none, "
          "or a list such as https://app.foxglove.dev,http://localhost:8081")
      ->capture_default_str();
  add_network_options(*monitor, options.network);
  monitor->footer(
      "The page shows everything and commands the robot; see docs/monitor.md. Viewers with the "
      "Foxglove\n"
      "WebSocket protocol connect to the same port. Ctrl-C ends the monitor; a robot it commanded then "
      "stands.");
  return monitor;
}

int run_monitor(const MonitorOptions& options) {
  const monitor::Origins may_look = viewers_of(options.viewers);
  std::expected<std::string, std::string> token;
  if (!options.token_file.empty()) token = telemetry::read_token(options.token_file);
  if (!token) throw std::runtime_error(token.error());
  if (options.terminal) {  // commands nothing
    monitor::DdsSource source(options.network, *token);
    return monitor::run_terminal(source);
  }
  monitor::DdsSource source(options.network, *token, [](const std::string& problem) {
    // It names a file as the robot names it.
    std::fprintf(stderr, "monitor: %s\n", monitor::printable(problem).c_str());
  });
  catch_signals();
  foxglove::FoxgloveEndpoint viewers("stilt monitor");
  const foxglove::Bridge bridge(options.network, viewers);
  monitor::ServeOptions serve;
  serve.server = {.address = options.address, .port = options.port, .names = options.names};
  serve.open_browser = !options.no_browser;
  serve.stop = &stop;
  serve.extend = [&](monitor::WebServer& server) {
    server.add_endpoint(foxglove::FoxgloveEndpoint::options(may_look), viewers);
  };
  monitor::serve(source, serve);
  return 0;
}

}  // namespace stilt::cli
