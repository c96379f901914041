#pragma once

#include <optional>
#include <string>
#include <vector>

namespace stilt::configuration {

/// The entries of a list of peers, which stand between commas and blanks.
[[nodiscard]] std::vector<std::string> peer_entries(const std::string& list);

/// Names the first entry that is neither an IPv4 address nor a host name, each with or without a port, such
/// as robot.local:7410. A name need not resolve: a robot may start before its name server.
[[nodiscard]] std::optional<std::string> peers_mistake(const std::string& list);

}  // namespace stilt::configuration
