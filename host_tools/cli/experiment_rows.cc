#include "host_tools/cli/experiment_rows.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <set>

#include "firmware/diagnostics/input_file.h"
#include "firmware/robots/robots.h"
#include "host_tools/cli/usage_error.h"
#include "host_tools/simulation/plant/number.h"

namespace stilt::cli {
namespace {

using Words = std::vector<std::string>;

std::string listed(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// The value of a key. Throws UsageError without the location when it is invalid.
class Value {
 public:
  explicit Value(const toml::node& node) : node_(node) {}

  [[nodiscard]] std::string text() const {
    const auto value = node_.value_exact<std::string>();
    if (!value) throw UsageError("must be a text");
    return *value;
  }

  [[nodiscard]] std::string one_of(const Words& known) const {
    const auto value = node_.value_exact<std::string>();
    if (!value || std::ranges::find(known, *value) == known.end()) {
      throw UsageError("must be one of " + listed(known));
    }
    return *value;
  }

  [[nodiscard]] std::string robot() const {
    const std::string name = text();
    if (const auto found = robots::find(name); !found) throw UsageError("is wrong: " + found.error());
    return name;
  }

  [[nodiscard]] double number() const {
    const auto value = node_.value<double>();
    if (!node_.is_number() || !std::isfinite(*value)) throw UsageError("must be a number");
    return *value;
  }

  [[nodiscard]] double number(double least, double most) const {
    const auto value = node_.value<double>();
    if (!node_.is_number() || !(*value >= least && *value <= most)) {
      throw UsageError("must be a number from " + simulation::number_text(least) + " to " +
                       simulation::number_text(most));
    }
    return *value;
  }

  [[nodiscard]] int whole(int least, int most) const {
    const auto value = node_.value_exact<std::int64_t>();
    if (!value || *value < least || *value > most) {
      throw UsageError("must be a whole number from " + std::to_string(least) + " to " +
                       std::to_string(most));
    }
    return static_cast<int>(*value);
  }

  /// Appends the texts of a list.
  void append_to(Words& words) const {
    const toml::array* array = node_.as_array();
    if (array == nullptr) throw UsageError("must be a list of texts");
    for (const toml::node& one : *array) {
      const auto value = one.value_exact<std::string>();
      if (!value) throw UsageError("must be a list of texts");
      words.push_back(*value);
    }
  }

 private:
  const toml::node& node_;
};

struct Key {
  const char* name;
  void (*read)(const Value&, RowChoice&);
};

const Key kKeys[] = {
    {"name", [](const Value& v, RowChoice& row) { row.name = v.text(); }},
    {"robot", [](const Value& v, RowChoice& row) { row.setting.choice.robot = v.robot(); }},
    {"controller",
     [](const Value& v, RowChoice& row) { row.setting.choice.controller = v.one_of(controller_names()); }},
    {"horizon_s", [](const Value& v, RowChoice& row) { row.setting.choice.horizon_s = v.number(); }},
    {"preset", [](const Value& v, RowChoice& row) { row.setting.choice.preset = v.text(); }},
    {"set", [](const Value& v, RowChoice& row) { v.append_to(row.setting.choice.settings); }},
    {"plant", [](const Value& v, RowChoice& row) { v.append_to(row.setting.plant_settings); }},
    {"gaits", [](const Value& v, RowChoice& row) { row.setting.choice.gait_folder = v.text(); }},
    {"lump", [](const Value& v, RowChoice& row) { row.setting.choice.lump = v.one_of(lump_names()); }},
    {"push_at", [](const Value& v, RowChoice& row) { row.setting.push_point = v.one_of({"hip", "torso"}); }},
    {"direction", [](const Value& v, RowChoice& row) { row.direction = v.one_of({"forward", "backward"}); }},
    {"gait", [](const Value& v, RowChoice& row) { row.gait = v.one_of({"walk", "step", "stand"}); }},
    {"speed_m_s",
     [](const Value& v, RowChoice& row) {
       row.speed_m_s = v.number(-kLargestRowSpeed_m_s, kLargestRowSpeed_m_s);
     }},
    {"plan_rate_hz", [](const Value& v, RowChoice& row) { row.setting.choice.plan_rate_hz = v.number(); }},
    {"plan_delay_s", [](const Value& v, RowChoice& row) { row.setting.choice.plan_delay_s = v.number(); }},
    {"state", [](const Value& v, RowChoice& row) { row.setting.state = v.one_of({"estimated", "truth"}); }},
    {"phases", [](const Value& v, RowChoice& row) { row.phases = v.whole(1, 64); }},
    {"seeds", [](const Value& v, RowChoice& row) { row.seeds = v.whole(1, 1000); }},
    {"coarse_N", [](const Value& v, RowChoice& row) { row.coarse_N = v.number(1.0, 100.0); }},
};

/// Runs `act` for a key, and adds the location to its errors.
void at(const std::string& place, const char* key, const std::function<void()>& act) {
  try {
    act();
  } catch (const std::exception& error) {
    throw UsageError(place + ", " + key + ": " + error.what());
  }
}

void check_name(const std::string& place, const RowChoice& row, std::set<std::string>& names) {
  constexpr const char* kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  if (row.name.empty() || row.name.find_first_not_of(kLetters) != std::string::npos) {
    throw UsageError(place + ", name: must be a text of letters, digits, points, minus signs, underscores");
  }
  if (!names.insert(row.name).second) throw UsageError(place + ", name: another row has this name");
}

/// Passes the values on to the functions that check them, one key after the other, so that errors name the
/// key.
void check_values(const std::string& place, const RowChoice& row) {
  WalkSetting setting = row.setting;
  ControllerChoice& choice = setting.choice;
  const ControllerChoice& wished = row.setting.choice;
  const auto parameters = [&] { (void)controller_parameters(choice); };
  at(place, "plant", [&] {
    simulation::PlantOptions options;
    for (const std::string& assignment : setting.plant_settings) set_plant_option(options, assignment);
  });
  at(place, "gaits", [&] { (void)gait_library(choice); });
  at(place, "controller", [&] { (void)planning_model(choice); });
  choice.horizon_s = choice.plan_rate_hz = choice.plan_delay_s = std::nullopt;
  choice.settings.clear();
  at(place, "preset", parameters);
  choice.settings = wished.settings;
  at(place, "set", parameters);
  choice.horizon_s = wished.horizon_s;
  at(place, "horizon_s", parameters);
  choice.plan_rate_hz = wished.plan_rate_hz;
  at(place, "plan_rate_hz", parameters);
  choice.plan_delay_s = wished.plan_delay_s;
  at(place, "plan_delay_s", parameters);
}

RowChoice read_row(const std::string& place, const toml::table& table, const RowChoice& defaults) {
  RowChoice row = defaults;
  for (const auto& [name, node] : table) {
    const auto key =
        std::ranges::find_if(kKeys, [&](const Key& k) { return std::string_view(k.name) == name.str(); });
    if (key == std::end(kKeys)) {
      Words known;
      for (const Key& k : kKeys) known.push_back(k.name);
      throw UsageError(place + ", " + std::string(name.str()) + ": no such key; known are " + listed(known));
    }
    at(place, key->name, [&] { key->read(Value(node), row); });
  }
  if (!table.contains("gaits")) row.setting = setting_for(row.setting, row.setting.choice.controller);
  return row;
}

toml::table parsed(const std::string& file) {
  const auto text = diagnostics::read_file(file);
  if (!text) throw UsageError("--rows " + file + ": the file cannot be read (" + text.error() + ")");
  try {
    return toml::parse(*text, file);
  } catch (const toml::parse_error& error) {
    throw UsageError("--rows " + file + ", line " + std::to_string(error.source().begin.line) + ": " +
                     std::string(error.description()));
  }
}

}  // namespace

std::vector<RowChoice> read_rows(const std::string& file, const RowChoice& defaults) {
  const toml::table tables = parsed(file);
  const toml::array* array = tables.get_as<toml::array>("row");
  if (array == nullptr || array->empty() || !array->is_homogeneous<toml::table>() || tables.size() != 1) {
    throw UsageError("--rows " + file + ": must hold tables [[row]] and nothing besides");
  }
  std::vector<RowChoice> rows;
  std::set<std::string> names;
  for (const toml::node& node : *array) {
    const toml::table& table = *node.as_table();
    const auto name = table["name"].value_exact<std::string>();
    const std::string place =
        "--rows " + file + ", row " + (name ? *name : "number " + std::to_string(rows.size() + 1));
    rows.push_back(read_row(place, table, defaults));
    check_name(place, rows.back(), names);
    check_values(place, rows.back());
  }
  return rows;
}

}  // namespace stilt::cli
