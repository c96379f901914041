#pragma once

#include <expected>
#include <set>
#include <string>

/// The sockets that Cyclone opens. Its receiving ones have the address 0.0.0.0 whatever interface it is
/// given: without more, a robot on loopback takes packets from every network. Start-up only.
namespace stilt::telemetry {

/// Descriptors of this process's UDP sockets. The error is one sentence for the user.
[[nodiscard]] std::expected<std::set<int>, std::string> udp_sockets();

/// Restricts all UDP sockets but those of `before` to one network interface (SO_BINDTODEVICE). The kernel
/// gives them no packet that comes through another one, and answers its sender "port unreachable". Packets
/// from this machine to an address of the interface still come. The error is one sentence for the user.
[[nodiscard]] std::expected<void, std::string> restrict_new_sockets(const std::set<int>& before,
                                                                    const std::string& interface);

}  // namespace stilt::telemetry
