#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace stilt::experiments {

using Json = nlohmann::ordered_json;

/// A part of an experiment that depends on no other part.
struct Job {
  std::string id;  ///< letters, digits, '.', '-', '_'
  std::function<Json()> run;
};

/// The results of an experiment's jobs, one small file each. An interrupted experiment can continue, and
/// several machines can share the work.
class JobFolder {
 public:
  /// Creates the folder when there is none. `settings` describes everything the results depend on and is
  /// stored in settings.json. Its field `configuration` has a hash for each part of the experiment; new parts
  /// are added, so that an experiment can grow. Throws std::invalid_argument, one sentence with the
  /// difference, when the folder holds results of other settings, or when it cannot be used.
  JobFolder(const std::filesystem::path& folder, const Json& settings);

  [[nodiscard]] bool has(const std::string& id) const;
  /// Throws std::runtime_error when the result is missing or damaged.
  [[nodiscard]] Json result(const std::string& id) const;
  /// Writes a result completely or not at all. Throws std::runtime_error.
  void keep(const std::string& id, const Json& result) const;

  /// The ids without a result, in order.
  [[nodiscard]] std::vector<std::string> missing(const std::vector<Job>& jobs) const;
  /// All results in the order of the jobs. Throws std::invalid_argument, one sentence, when some are missing.
  [[nodiscard]] std::vector<Json> results(const std::vector<Job>& jobs) const;

 private:
  [[nodiscard]] std::filesystem::path file(const std::string& id) const { return folder_ / (id + ".json"); }

  std::filesystem::path folder_;
};

}  // namespace stilt::experiments
