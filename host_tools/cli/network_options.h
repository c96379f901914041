#pragma once

#include <CLI/App.hpp>

#include "firmware/telemetry/participant.h"

namespace stilt::cli {

/// Options of every command that talks with stiltd over the network: --domain, --interface, --peers,
/// --security-folder, the same as the keys of the controller's section telemetry.
void add_network_options(CLI::App& command, telemetry::Network& network);

}  // namespace stilt::cli
