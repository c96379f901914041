#pragma once

#include <CLI/App.hpp>

#include "firmware/telemetry/participant.h"

namespace stilt::cli {

/// Adds the network options of all commands that communicate with stiltd: --domain, --interface, --peers,
/// --security-folder. They equal the keys of the controller's section telemetry.
void add_network_options(CLI::App& command, telemetry::Network& network);

}  // namespace stilt::cli
