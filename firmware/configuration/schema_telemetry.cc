#include "firmware/configuration/peers.h"
#include "firmware/configuration/schema_fields.h"
#include "firmware/configuration/schema_tables.h"

namespace stilt::configuration {
namespace {

using namespace fields;
using P = Parameters;
using T = TelemetryParameters;

constexpr std::size_t kLongestInterface = 15;

constexpr Section kSections[] = {
    {"telemetry", "What stiltd publishes over DDS, and whose commands it takes."}};

std::optional<std::string> interface_mistake(const std::string& name) {
  const bool right = !name.empty() && name.size() <= kLongestInterface &&
                     name.find_first_of(" /<>&\"'") == std::string::npos;
  if (right) return std::nullopt;
  return "\"" + name + "\" is no name of an interface; `ip link` lists them, lo is this computer alone";
}

/// What stands in Cyclone's XML.
std::optional<std::string> path_mistake(const std::string& path) {
  const bool right = path == "none" || path == "auto" ||
                     (path.starts_with('/') && path.find_first_of("<>&'") == std::string::npos);
  if (right) return std::nullopt;
  return "\"" + path + "\" is no absolute path";
}

constexpr Entry kEntries[] = {
    {"telemetry", "enabled", "", "Publish telemetry and take commands", flag<&P::telemetry, &T::enabled>()},
    {"telemetry", "interface", "", "The one network interface; lo is this computer alone",
     text<&P::telemetry, &T::interface>("the name of an interface", interface_mistake)},
    {"telemetry", "domain", "1", "DDS domain; robot and host use the same",
     integer<&P::telemetry, &T::domain>(0, 230)},
    {"telemetry", "peers", "", "Addresses of hosts where multicast does not reach them",
     text<&P::telemetry, &T::peers>("addresses with commas between, or \"none\"", peers_mistake)},
    {"telemetry", "security_folder", "",
     "Folder of the documents of DDS Security (docs/security.md); without, every computer of the network can "
     "listen",
     text<&P::telemetry, &T::security_folder>("an absolute path, or \"none\"", path_mistake)},
    {"telemetry", "token_file", "",
     "File with the token that commands need; auto: in $XDG_RUNTIME_DIR or /tmp, stiltd prints where",
     text<&P::telemetry, &T::token_file>("an absolute path, or \"auto\"", path_mistake)},
    {"telemetry", "fixed_token", "",
     "Take the token that is in the file instead of writing a new one at the start",
     flag<&P::telemetry, &T::fixed_token>()},
    {"telemetry", "speed_limit_m_s", "m/s", "Fastest walk that is commanded, either way",
     real<&P::telemetry, &T::speed_limit_m_s>(0.0, 5.0)},
    {"telemetry", "release_s", "s",
     "Silence after which a commander is out of command; supervisor.heartbeat_timeout_s slows the robot down "
     "before",
     real<&P::telemetry, &T::release_s>(0.1, 60.0)},
    {"telemetry", "cmd_vel", "",
     "Let rt/cmd_vel (Twist) change the speed of a walk while a commander sends heartbeats",
     flag<&P::telemetry, &T::cmd_vel>()},
    {"telemetry", "ticks_per_batch", "1", "Ticks in a sample of the torque loop's record",
     integer<&P::telemetry, &T::ticks_per_batch>(1, 50)},
    {"telemetry", "joint_states_hz", "Hz", "Rate of joint_states and odom",
     real<&P::telemetry, &T::joint_states_hz>(1.0, 1000.0)},
    {"telemetry", "supervisor_hz", "Hz", "Rate of the supervisor's state, which also comes with every change",
     real<&P::telemetry, &T::supervisor_hz>(1.0, 1000.0)},
};

}  // namespace

std::span<const Section> telemetry_sections() { return kSections; }

std::span<const Entry> telemetry_entries() { return kEntries; }

}  // namespace stilt::configuration
