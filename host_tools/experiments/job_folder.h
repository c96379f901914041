#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace stilt::experiments {

using Json = nlohmann::ordered_json;

/// A piece of an experiment that depends on no other one.
struct Job {
  std::string id;  ///< letters, digits, point, minus, underscore
  std::function<Json()> run;
};

/// The results of an experiment's jobs, one small file each, so that an interrupted experiment goes on where
/// it was and several machines can share the work.
class JobFolder {
 public:
  /// Creates the folder when there is none. `settings` describes everything the results depend on and is
  /// kept in settings.json. Its field `configuration` has a hash for each part of the experiment; parts that
  /// the folder does not have yet are added, so that an experiment can be widened. Throws
  /// std::invalid_argument, one sentence that names the difference, when the folder holds results of other
  /// settings, and when it cannot be used.
  JobFolder(const std::filesystem::path& folder, const Json& settings);

  [[nodiscard]] bool has(const std::string& id) const;
  /// Throws std::runtime_error when there is no such result or it is damaged.
  [[nodiscard]] Json result(const std::string& id) const;
  /// Writes a result, whole or not at all. Throws std::runtime_error.
  void keep(const std::string& id, const Json& result) const;

  /// The ids without a result, in order.
  [[nodiscard]] std::vector<std::string> missing(const std::vector<Job>& jobs) const;
  /// All results in order of the jobs. Throws std::invalid_argument, one sentence, when some are missing.
  [[nodiscard]] std::vector<Json> results(const std::vector<Job>& jobs) const;

 private:
  [[nodiscard]] std::filesystem::path file(const std::string& id) const { return folder_ / (id + ".json"); }

  std::filesystem::path folder_;
};

}  // namespace stilt::experiments
