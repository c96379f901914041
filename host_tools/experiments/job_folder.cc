#include "host_tools/experiments/job_folder.h"

#include <unistd.h>

#include <fstream>
#include <stdexcept>

// Jobs of an experiment: docs/decisions/0013-experiments.md
namespace stilt::experiments {
namespace {

Json read(const std::filesystem::path& file) {
  std::ifstream stream(file);
  const Json json = Json::parse(stream, nullptr, false);
  if (!json.is_object() || json.empty()) {
    throw std::runtime_error(file.string() + ": no result that can be read; remove the file and run the job");
  }
  return json;
}

/// Names of files need not be UTF-8; what is not is replaced.
std::string text_of(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace); }

/// Writes under another name first, so that no reader gets half a file.
void write(const std::filesystem::path& file, const Json& json) {
  const std::filesystem::path part = file.string() + "." + std::to_string(getpid()) + ".part";
  std::ofstream stream(part);
  stream << text_of(json) << '\n' << std::flush;
  std::error_code error;
  if (stream) std::filesystem::rename(part, file, error);
  if (!stream || error) throw std::runtime_error(file.string() + ": the file cannot be written");
}

constexpr const char* kParts = "configuration";

std::string value_text(const Json& settings, const std::string& key) {
  if (!settings.contains(key)) return "none";
  return settings.at(key).is_string() ? settings.at(key).get<std::string>() : settings.at(key).dump();
}

/// The difference between stored and new settings as text; empty when their results are compatible.
std::string difference(const Json& kept, const Json& settings) {
  Json keys = settings;
  keys.update(kept);
  for (const auto& [key, value] : keys.items()) {
    if (key == kParts || value_text(kept, key) == value_text(settings, key)) continue;
    return "another " + key + " (" + value_text(kept, key) + " there, " + value_text(settings, key) +
           " here)";
  }
  const Json parts = kept.value(kParts, Json::object());
  const Json new_parts = settings.value(kParts, Json::object());
  for (const auto& [part, hash] : new_parts.items()) {
    if (parts.contains(part) && parts.at(part) != hash) return "another configuration of " + part;
  }
  return "";
}

}  // namespace

JobFolder::JobFolder(const std::filesystem::path& folder, const Json& given) : folder_(folder) {
  const Json settings = Json::parse(text_of(given));  // as it is stored
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (!std::filesystem::is_directory(folder_, error) || access(folder_.c_str(), W_OK) != 0) {
    throw std::invalid_argument("--out " + folder.string() +
                                ": no folder that can be written; name one in an existing, writable folder");
  }
  const std::filesystem::path kept_file = file("settings");
  Json all = settings;
  if (std::filesystem::exists(kept_file)) {
    const Json kept = read(kept_file);
    if (const std::string what = difference(kept, settings); !what.empty()) {
      throw std::invalid_argument("--out " + folder.string() + ": its settings.json names " + what +
                                  "; name another folder");
    }
    all = kept;
    if (settings.contains(kParts)) all[kParts].update(settings.at(kParts));
    if (all == kept) return;
  }
  write(kept_file, all);
}

bool JobFolder::has(const std::string& id) const { return std::filesystem::exists(file(id)); }

Json JobFolder::result(const std::string& id) const { return read(file(id)); }

void JobFolder::keep(const std::string& id, const Json& result) const { write(file(id), result); }

std::vector<std::string> JobFolder::missing(const std::vector<Job>& jobs) const {
  std::vector<std::string> ids;
  for (const Job& job : jobs) {
    if (!has(job.id)) ids.push_back(job.id);
  }
  return ids;
}

std::vector<Json> JobFolder::results(const std::vector<Job>& jobs) const {
  const std::vector<std::string> absent = missing(jobs);
  if (!absent.empty()) {
    throw std::invalid_argument("--merge: " + std::to_string(absent.size()) + " of " +
                                std::to_string(jobs.size()) + " results are missing in " + folder_.string() +
                                ", the first is " + absent.front() + "; run the jobs first");
  }
  std::vector<Json> all;
  for (const Job& job : jobs) all.push_back(result(job.id));
  return all;
}

}  // namespace stilt::experiments
