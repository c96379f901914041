#include "host_tools/cli/network_options.h"

namespace stilt::cli {

void add_network_options(CLI::App& command, telemetry::Network& network) {
  command.add_option("--domain", network.domain, "DDS domain, the controller's telemetry.domain")
      ->check(CLI::Range(0, 230))
      ->capture_default_str();
  command.add_option("--interface", network.interface, "network interface; lo: only this machine")
      ->capture_default_str();
  command.add_option("--peers", network.peers,
                     "addresses of other machines, separated by commas, where multicast does not work");
  command.add_option("--security-folder", network.security_folder,
                     "folder of DDS Security documents, see docs/security.md; default: none");
}

}  // namespace stilt::cli
