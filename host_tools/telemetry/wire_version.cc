#include "host_tools/telemetry/wire_version.h"

#include "firmware/telemetry/wire_version.h"

namespace stilt::host_telemetry {

std::optional<std::string> wire_version_problem(std::optional<std::uint32_t> version) {
  if (version == telemetry::kWireVersion) return std::nullopt;
  const std::string found = version ? "has messages of wire version " + std::to_string(*version)
                                    : "has the messages of release 0.1";
  return found + ", but this stilt reads wire version " + std::to_string(telemetry::kWireVersion) +
         "; use the stilt of the same release as stiltd";
}

}  // namespace stilt::host_telemetry
