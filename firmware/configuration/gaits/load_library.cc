#include <algorithm>
#include <filesystem>
#include <vector>

#include "firmware/configuration/gaits/gait_file.h"
#include "firmware/configuration/gaits/shipped_gaits.h"
#include "firmware/robots/robots.h"

namespace stilt::gait_files {
namespace {

struct NamedRecord {
  std::string file;
  GaitRecord record;
};

const char* reason(gait::LibraryStatus status) {
  switch (status) {
    case gait::LibraryStatus::ok:
      return "";
    case gait::LibraryStatus::full:
      return "the library is full; at most 32 gaits are held";
    case gait::LibraryStatus::motion_unknown:
      return "the file has outputs alone; stilt gait complete adds the motion";
    case gait::LibraryStatus::speeds_not_rising:
      return "another gait has the same speed; keep one of them";
    case gait::LibraryStatus::another_shape:
      return "step time and degree of the states must be those of the slowest gait; make all by one stilt "
             "gait library";
  }
  return "";
}

/// A URDF file may be named in several ways.
bool same_robot(const std::string& one, std::string_view other) {
  std::error_code error;
  return one == other ||
         (robots::is_file(one) && robots::is_file(other) && std::filesystem::equivalent(one, other, error));
}

std::expected<void, std::string> fill(std::vector<NamedRecord>& records, std::string_view robot,
                                      gait::GaitLibrary& library) {
  library.clear();
  std::sort(records.begin(), records.end(), [](const NamedRecord& a, const NamedRecord& b) {
    return a.record.gait.speed_m_s < b.record.gait.speed_m_s;
  });
  for (const NamedRecord& named : records) {
    std::string wrong;
    if (!same_robot(named.record.robot, robot)) {
      wrong = "this is a gait of " + named.record.robot + "; one of " + std::string(robot) + " is needed";
    } else {
      wrong = reason(library.add(named.record.gait));
    }
    if (wrong.empty()) continue;
    library.clear();
    return std::unexpected(named.file + ": " + wrong);
  }
  return {};
}

}  // namespace

std::expected<void, std::string> load_shipped_library(std::string_view robot, gait::GaitLibrary& library) {
  std::vector<NamedRecord> records;
  for (const ShippedGait& shipped : shipped_gaits()) {
    if (shipped.robot != robot) continue;
    auto record = parse_gait(shipped.text, shipped.path);
    if (!record) return std::unexpected(record.error());
    records.push_back({std::string(shipped.path), std::move(*record)});
  }
  if (records.empty()) {
    return std::unexpected("no gaits of " + std::string(robot) + " are shipped");
  }
  return fill(records, robot, library);
}

std::expected<void, std::string> load_library(const std::string& folder, std::string_view robot,
                                              gait::GaitLibrary& library) {
  std::vector<NamedRecord> records;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".toml") continue;
    auto record = load_gait(entry.path().string());
    if (!record) return std::unexpected(record.error());
    records.push_back({entry.path().string(), std::move(*record)});
  }
  if (records.empty()) {
    return std::unexpected(folder +
                           ": no gait files (*.toml) here; name a folder that stilt gait library wrote");
  }
  return fill(records, robot, library);
}

}  // namespace stilt::gait_files
