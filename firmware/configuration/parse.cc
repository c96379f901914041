#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <tuple>
#include <utility>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/consistency.h"
#include "firmware/configuration/renames.h"
#include "firmware/configuration/schema.h"
#include "firmware/diagnostics/input_file.h"
#include "firmware/robots/robots.h"

namespace stilt::configuration {
namespace {

/// Stance of a URDF's robot, as shares of the length of its legs: those of the shipped robots.
constexpr double kHeightShare = 0.916;
constexpr double kHalfWidthShare = 0.172;

/// Where a value was set; the message is filled in when something is wrong with it.
using Place = Diagnostic;

std::vector<std::string_view> section_names() {
  std::vector<std::string_view> names;
  for (const Section& section : sections()) names.push_back(section.name);
  return names;
}

bool is_section(std::string_view name) {
  return std::ranges::any_of(sections(), [&](const Section& section) { return section.name == name; });
}

/// "; did you mean gait.swing_height_m?", or where the known names are listed.
std::string suggestion(std::string_view section, std::string_view key) {
  std::vector<std::string_view> keys;
  for (const Entry& entry : entries()) {
    if (entry.section == section) keys.push_back(entry.key);
  }
  std::string_view likely_section = section;
  std::string_view likely_key = nearest(key, keys);
  if (likely_key.empty()) {
    // The right key in the wrong section.
    for (const Entry& entry : entries()) {
      if (entry.key != key) continue;
      likely_section = entry.section;
      likely_key = entry.key;
    }
  }
  if (likely_key.empty()) return "; the shipped files name every key";
  return "; did you mean " + std::string(likely_section) + '.' + std::string(likely_key) + '?';
}

std::string unknown_section(std::string_view name) {
  const std::vector<std::string_view> names = section_names();
  std::string text = "unknown section " + std::string(name);
  if (const std::string_view likely = nearest(name, names); !likely.empty()) {
    return text + "; did you mean " + std::string(likely) + '?';
  }
  text += "; sections are ";
  for (std::size_t i = 0; i < names.size(); ++i) text += (i > 0 ? ", " : "") + std::string(names[i]);
  return text;
}

std::string unknown_key(std::string_view section, std::string_view key) {
  return "unknown key " + std::string(section) + '.' + std::string(key) + suggestion(section, key);
}

/// Collects values and mistakes from a file, a preset and overrides.
class Reader {
 public:
  explicit Reader(std::string_view file) : file_(file), folder_(std::filesystem::path(file).parent_path()) {}

  /// `path` names the text in diagnostics.
  void read(std::string_view text, std::string_view path);
  void read_preset(std::string_view name);
  void apply(const Override& change);
  [[nodiscard]] Result finish();

 private:
  [[nodiscard]] Place place(const toml::source_region& source) const {
    const std::string& path = source.path != nullptr ? *source.path : file_;
    return {path, static_cast<int>(source.begin.line), static_cast<int>(source.begin.column), {}};
  }
  void fail_renamed(Place place, const Rename& rename) {
    std::string message = to_string(rename);
    if (rename.value_change.empty()) message += "; stilt config migrate " + place.file + " rewrites the file";
    fail(std::move(place), std::move(message));
  }
  void fail(Place place, std::string message) {
    place.message = std::move(message);
    diagnostics_.push_back(std::move(place));
  }
  void read_key(std::string_view section, const toml::key& key, const toml::node& node);
  void set(const Entry& entry, const Value& value, Place place);
  void derive_stance();
  [[nodiscard]] Place place_of(const Contradiction& contradiction) const;
  /// 0 for a place in the file, 1 in the preset, 2 in an override.
  [[nodiscard]] int layer(const Place& place) const {
    if (place.line == 0) return 2;
    return place.file == file_ ? 0 : 1;
  }

  std::string file_;
  std::filesystem::path folder_;  // of the file: a relative URDF is found from there
  Parameters parameters_;
  std::map<std::string, Place, std::less<>> places_;  // of the values that were set
  std::vector<Diagnostic> diagnostics_;
};

void Reader::read_preset(std::string_view name) {
  for (const ShippedPreset& preset : shipped_presets()) {
    if (preset.name == name) return read(preset.text, preset.path);
  }
  fail({"--preset", 0, 0, {}},
       "there is no preset \"" + std::string(name) + "\"; known presets are " + preset_names());
}

void Reader::read(std::string_view text, std::string_view path) {
  toml::table root;
  try {
    root = toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    fail(place(error.source()), "not valid TOML: " + std::string(error.description()));
    return;
  }
  for (auto&& [key, node] : root) {
    const std::string_view section = key.str();
    if (const Rename* rename = find_rename(section)) {
      fail_renamed(place(key.source()), *rename);
    } else if (!is_section(section)) {
      fail(place(key.source()), unknown_section(section));
    } else if (const toml::table* table = node.as_table()) {
      for (auto&& [inner_key, value] : *table) read_key(section, inner_key, value);
    } else {
      fail(place(key.source()),
           std::string(section) + " must be a section of keys, [" + std::string(section) + "], not a value");
    }
  }
}

void Reader::read_key(std::string_view section, const toml::key& key, const toml::node& node) {
  if (const Rename* rename = find_rename(section, key.str())) {
    return fail_renamed(place(key.source()), *rename);
  }
  const Entry* entry = find_entry(section, key.str());
  if (entry == nullptr) return fail(place(key.source()), unknown_key(section, key.str()));
  const Place here = place(node.source());
  if (const auto* real = node.as_floating_point()) {
    set(*entry, real->get(), here);
  } else if (const auto* whole = node.as_integer()) {
    set(*entry, static_cast<long long>(whole->get()), here);
  } else if (const auto* flag = node.as_boolean()) {
    set(*entry, flag->get(), here);
  } else if (const auto* word = node.as_string()) {
    const bool is_urdf = entry->name() == "hardware.robot" && robots::is_file(word->get());
    set(*entry, is_urdf ? (folder_ / word->get()).string() : word->get(), here);
  } else {
    fail(here,
         entry->name() + " must be a single value (" + range_text(*entry) + "), not a list, table or date");
  }
}

void Reader::set(const Entry& entry, const Value& value, Place place) {
  if (auto mistake = assign(entry, value, parameters_)) {
    fail(std::move(place), std::move(*mistake));
  } else {
    places_[entry.name()] = std::move(place);
  }
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// The value of an override: true, false, a whole number, a number, otherwise a word.
Value word_value(std::string_view text) {
  if (text == "true") return true;
  if (text == "false") return false;
  const char* end = text.data() + text.size();
  long long whole = 0;
  if (const auto read = std::from_chars(text.data(), end, whole); read.ec == std::errc{} && read.ptr == end) {
    return whole;
  }
  double real = 0.0;
  if (const auto read = std::from_chars(text.data(), end, real); read.ec == std::errc{} && read.ptr == end) {
    return real;
  }
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return std::string(text);
}

void Reader::apply(const Override& change) {
  const Place here{change.where, 0, 0, {}};
  const std::string_view text = change.assignment;
  const std::size_t equals = text.find('=');
  const std::string_view name = trimmed(text.substr(0, equals));
  const std::size_t dot = name.find('.');
  if (equals == std::string_view::npos || dot == std::string_view::npos) {
    fail(here, '"' + change.assignment + "\" must have the form section.key=value, such as " +
                   "discretisation.horizon_s=1.0");
    return;
  }
  const std::string_view section = name.substr(0, dot);
  const std::string_view key = name.substr(dot + 1);
  if (const Rename* rename = find_rename(section, key)) {
    fail(here, std::string(section) + '.' + to_string(*rename));
  } else if (const Rename* renamed_section = find_rename(section)) {
    fail(here, "section " + to_string(*renamed_section));
  } else if (!is_section(section)) {
    fail(here, unknown_section(section));
  } else if (const Entry* entry = find_entry(section, key)) {
    set(*entry, word_value(trimmed(text.substr(equals + 1))), here);
  } else {
    fail(here, unknown_key(section, key));
  }
}

/// An override is the likeliest culprit, then the preset, then the first of the keys that the file sets.
Place Reader::place_of(const Contradiction& contradiction) const {
  const Place* best = nullptr;
  for (const std::string_view key : contradiction.keys) {
    const auto found = places_.find(key);
    if (found == places_.end()) continue;
    if (best == nullptr || layer(found->second) > layer(*best)) best = &found->second;
  }
  return best == nullptr ? Place{file_, 0, 0, {}} : *best;
}

/// The stance of a URDF's robot where neither file, preset nor override sets it.
void Reader::derive_stance() {
  if (!robots::is_file(parameters_.hardware.robot)) return;
  const auto robot = robots::find(parameters_.hardware.robot);
  if (!robot) return;  // refused where it is set
  const model::RobotConstants& constants = (*robot)->model.constants;
  const double leg_m = constants.thigh_length_m + constants.shin_length_m;
  for (const auto& [section, key, share] : {std::tuple("reference", "base_height_m", kHeightShare),
                                            std::tuple("gait", "stand_half_width_m", kHalfWidthShare)}) {
    const Entry& entry = *find_entry(section, key);
    if (places_.contains(entry.name())) continue;
    if (auto mistake = assign(entry, share * leg_m, parameters_)) {
      fail(places_.at("hardware.robot"), std::move(*mistake));
    }
  }
}

Result Reader::finish() {
  derive_stance();
  // Tables come by name; people read by line. Overrides have no line and keep their order.
  std::ranges::stable_sort(diagnostics_, {}, [this](const Diagnostic& diagnostic) {
    return std::tuple(layer(diagnostic), diagnostic.line, diagnostic.column);
  });
  if (diagnostics_.empty()) {
    for (Contradiction& contradiction : contradictions(parameters_)) {
      fail(place_of(contradiction), std::move(contradiction.message));
    }
  }
  if (!diagnostics_.empty()) return std::unexpected(std::move(diagnostics_));
  return parameters_;
}

std::unexpected<std::vector<Diagnostic>> failure(std::string file, std::string message) {
  return std::unexpected(std::vector{Diagnostic{std::move(file), 0, 0, std::move(message)}});
}

}  // namespace

std::string preset_names() {
  std::string names;
  for (const ShippedPreset& preset : shipped_presets()) {
    names += (names.empty() ? "" : ", ") + std::string(preset.name);
  }
  return names;
}

Result parse(std::string_view toml, std::string_view file, std::span<const Override> overrides,
             std::string_view preset) {
  Reader reader(file);
  reader.read(toml, file);
  if (!preset.empty()) reader.read_preset(preset);
  for (const Override& change : overrides) reader.apply(change);
  return reader.finish();
}

void keep_torque_limit(Configuration& configuration) {
  supervisor::SupervisorParameters& supervisor = configuration.supervisor;
  double& scale = configuration.robot.torque_limit_scale;
  if (supervisor.torque_limit_share < 1.0) scale = std::min(scale, supervisor.torque_limit_share);
  if (!supervisor::may_walk(supervisor)) configuration.gait.catch_falls = false;
}

Result load_file(const std::string& path, std::span<const Override> overrides, std::string_view preset) {
  const auto text = diagnostics::read_file(path);
  if (!text) return failure(path, "cannot be read (" + text.error() + "); name a configuration file");
  return parse(*text, path, overrides, preset);
}

std::string file_beside(std::string_view urdf) {
  return std::filesystem::path(urdf).replace_extension(".toml").string();
}

std::vector<std::string> files_of_robot(std::string_view robot) {
  if (!robots::is_file(robot)) return {};
  return {std::string(robot), file_beside(robot)};
}

std::string robot_in_file(std::string_view file, std::string_view robot) {
  const std::filesystem::path urdf(robot), here = std::filesystem::current_path();
  if (!robots::is_file(robot) || urdf.is_absolute()) return urdf.string();
  const auto folder_of = [&here](const std::filesystem::path& path) {
    return (here / path).lexically_normal().parent_path();
  };
  return folder_of(file) == folder_of(urdf) ? urdf.filename().string() : (here / urdf).string();
}

Result load_robot(std::string_view robot, std::span<const Override> overrides, std::string_view preset) {
  const auto found = robots::find(robot);
  if (!found) return failure("--robot", found.error());
  const std::string beside = file_beside(robot);
  const bool has_file = robots::is_file(robot) && std::filesystem::exists(beside);
  std::vector<Override> all = {{"hardware.robot=" + (*found)->name, "--robot"}};
  all.insert(all.end(), overrides.begin(), overrides.end());
  if (has_file) return load_file(beside, all, preset);
  for (const ShippedConfiguration& shipped : shipped_configurations()) {
    if (shipped.robot == robot) return parse(shipped.text, shipped.path, all, preset);
  }
  return parse("", "the defaults", all, preset);
}

Result load(const std::string& file, std::string_view robot, std::span<const Override> overrides,
            std::string_view preset) {
  if (file.empty()) return load_robot(robot.empty() ? kDefaultRobot : robot, overrides, preset);
  std::vector<Override> all;
  if (!robot.empty()) all.push_back({"hardware.robot=" + std::string(robot), "--robot"});
  all.insert(all.end(), overrides.begin(), overrides.end());
  return load_file(file, all, preset);
}

}  // namespace stilt::configuration
