#include "host_tools/web/monitor/page_commands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

namespace stilt::monitor {
namespace {

using Json = nlohmann::json;

/// Those that a page may send.
constexpr std::array<CommandKind, 11> kKinds = {
    CommandKind::stand,   CommandKind::step,      CommandKind::walk, CommandKind::speed,
    CommandKind::height,  CommandKind::sit,       CommandKind::stop, CommandKind::reset,
    CommandKind::tunable, CommandKind::heartbeat, CommandKind::cut};

/// The member of that name, or the fallback when it is missing. Throws Json::exception for another type.
template <class Value>
Value member(const Json& json, const char* key, Value fallback) {
  return json.contains(key) ? json.at(key).get<Value>() : std::move(fallback);
}

std::expected<CommandKind, std::string> kind_of(const std::string& text) {
  const auto found =
      std::ranges::find_if(kKinds, [&text](CommandKind kind) { return text == telemetry::name(kind); });
  if (found != kKinds.end()) return *found;
  return std::unexpected(
      "'" + text +
      "' is no command; stand, step, walk, speed, height, sit, stop, cut, reset and tunable are");
}

std::expected<PageMessage, std::string> read(const Json& json) {
  PageMessage message;
  if (json.contains("from")) message.from_s = json.at("from").get<double>();
  if (json.contains("hold")) message.hold = json.at("hold").get<bool>();
  message.run = member<std::string>(json, "run", "");
  message.key = member<std::string>(json, "key", "");
  message.new_key = member(json, "new_key", false);
  if (json.contains("link_time_s")) message.link_time_s = json.at("link_time_s").get<double>();
  if (!json.contains("command")) return message;
  const auto kind = kind_of(json.at("command").get<std::string>());
  if (!kind) return std::unexpected(kind.error());
  message.is_command = true;
  Command& command = message.command;
  command.kind = *kind;
  const Json& sequence = json.at("sequence");
  if (!sequence.is_number_unsigned() ||
      sequence.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    return std::unexpected(std::string("the sequence is no whole number of 32 bits"));
  }
  command.sequence = sequence.get<std::uint32_t>();
  command.token = member<std::string>(json, "token", "");
  command.tokens_of_others = member<std::map<std::string, std::string>>(json, "tokens", {});
  command.value = member(json, "value", 0.0);
  command.tunable = member<std::string>(json, "tunable", "");
  if (!std::isfinite(command.value)) return std::unexpected(std::string("the value is not a number"));
  return message;
}

}  // namespace

std::expected<PageMessage, std::string> parse_page_message(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    if (!json.is_object()) return std::unexpected(std::string("a message of the page is a JSON object"));
    return read(json);
  } catch (const Json::exception& error) {
    return std::unexpected(std::string("not a message of the page: ") + error.what());
  }
}

}  // namespace stilt::monitor
