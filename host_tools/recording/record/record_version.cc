#include "host_tools/recording/record/record_version.h"

#include <charconv>
#include <optional>
#include <stdexcept>

#include "firmware/telemetry/cdr.h"
#include "firmware/telemetry/topics.h"
#include "host_tools/recording/record/recorder.h"
#include "host_tools/telemetry/wire_version.h"

namespace stilt::record {
namespace {

bool is_configuration(const mcap::ReadMessage& read) {
  return topic_of_record(read.channel->topic) == &telemetry::kConfiguration;
}

/// The definition in the record shows whether its messages have a version.
bool has_version(const mcap::ReadMessage& read) {
  return read.schema == nullptr || read.schema->text.find(" wire_version\n") != std::string::npos;
}

/// A sentence without the path that it begins with.
std::string without_path(const std::string& path, const std::string& problem) {
  return problem.substr(problem.starts_with(path + ": ") ? path.size() + 2 : 0);
}

}  // namespace

void require_wire_version(const std::string& path, const mcap::ReadMessage& read) {
  if (!is_configuration(read)) return;
  std::optional<std::uint32_t> version;
  if (has_version(read)) {
    const auto message = telemetry::decode<telemetry::ActiveConfiguration>(std::as_bytes(read.message.data));
    if (!message) return;
    version = message->wire_version;
  }
  if (const auto problem = host_telemetry::wire_version_problem(version)) {
    throw std::runtime_error(path + ": " + *problem);
  }
}

void require_wire_version(const std::string& path) {
  mcap::Reader reader(path);
  while (const mcap::ReadMessage* read = reader.next()) {
    require_wire_version(path, *read);
    if (is_configuration(*read)) return;
  }
}

void require_wire_version(const std::string& path, const mcap::Metadata& of_run) {
  std::optional<std::uint32_t> version;
  if (const auto entry = of_run.entries.find("wire_version"); entry != of_run.entries.end()) {
    const std::string& text = entry->second;
    std::from_chars(text.data(), text.data() + text.size(), version.emplace(0));
  }
  if (const auto problem = host_telemetry::wire_version_problem(version)) {
    throw std::runtime_error(path + ": " + *problem);
  }
}

std::string without_configuration(const std::string& path, const std::vector<std::string>& problems) {
  return problems.empty() ? "record from before stiltd ends" : without_path(path, problems.front());
}

std::string without_ticks(const std::string& path, const std::vector<std::string>& problems) {
  const std::string none = path + ": holds no ticks of stiltd";
  if (problems.empty()) return none + "; name a record of stilt record";
  return none + " that can be read: " + without_path(path, problems.front());
}

}  // namespace stilt::record
