#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "firmware/configuration/gaits/gait_file.h"
#include "firmware/configuration/gaits/gait_names.h"
#include "firmware/diagnostics/input_file.h"
#include "firmware/robots/robots.h"

namespace stilt::gait_files {
namespace {

/// What is wrong with a file; never leaves this file.
class Wrong : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One table of the file, with messages that name the place.
class Table {
 public:
  enum class Numbers { finite, any };

  Table(const toml::table& table, std::string name, Numbers allowed = Numbers::finite)
      : table_(table), name_(std::move(name)), allowed_(allowed) {}

  [[nodiscard]] bool has(const char* key) const { return table_.contains(key); }

  [[nodiscard]] double number(const char* key) const {
    const toml::node* node = table_.get(key);
    const auto value = node != nullptr ? node->value<double>() : std::nullopt;
    if (!value || !allows(*value)) throw Wrong(place(key) + " must be a number");
    return *value;
  }

  [[nodiscard]] double number_or(const char* key, double otherwise) const {
    return has(key) ? number(key) : otherwise;
  }

  [[nodiscard]] int integer(const char* key, int least, int most) const {
    const toml::node* node = table_.get(key);
    const auto value = node != nullptr ? node->value_exact<std::int64_t>() : std::nullopt;
    if (!value || *value < least || *value > most) {
      throw Wrong(place(key) + " must be a whole number from " + std::to_string(least) + " to " +
                  std::to_string(most));
    }
    return static_cast<int>(*value);
  }

  [[nodiscard]] std::string word(const char* key, std::initializer_list<const char*> known) const {
    const toml::node* node = table_.get(key);
    const auto value = node != nullptr ? node->value_exact<std::string>() : std::nullopt;
    std::string all;
    for (const char* one : known) {
      if (value && *value == one) return *value;
      all += (all.empty() ? "\"" : " or \"") + std::string(one) + "\"";
    }
    throw Wrong(place(key) + " must be " + (all.empty() ? "a text" : all));
  }

  /// @param folder  of the file, from which a relative URDF is found
  [[nodiscard]] std::string robot(const char* key, const std::filesystem::path& folder) const {
    const toml::node* node = table_.get(key);
    const auto value = node != nullptr ? node->value_exact<std::string>() : std::nullopt;
    if (!value) throw Wrong(place(key) + " must be the name of a robot or a URDF file");
    const std::string robot = robots::is_file(*value) ? (folder / *value).string() : *value;
    if (const auto found = robots::find(robot); !found) throw Wrong(place(key) + ": " + found.error());
    return robot;
  }

  void numbers(const char* key, std::span<double> values) const {
    const toml::array* array = table_.get_as<toml::array>(key);
    if (array == nullptr || array->size() != values.size()) {
      throw Wrong(place(key) + " must be a list of " + std::to_string(values.size()) + " numbers");
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto value = array->get(i)->value<double>();
      if (!value || !allows(*value)) throw Wrong(place(key) + " must hold finite numbers alone");
      values[i] = *value;
    }
  }

  template <class T>
  void fields(std::span<const Field<T>> rows, T& object) const {
    for (const Field<T>& row : rows) {
      const std::span<double> values = row.values(object);
      if (!has(row.key)) continue;
      if (values.size() == 1) {
        values[0] = number(row.key);
      } else {
        numbers(row.key, values);
      }
    }
    std::vector<std::string_view> keys;
    for (const Field<T>& row : rows) keys.emplace_back(row.key);
    know(keys);
  }

  /// Refuses every other key.
  void know(std::span<const std::string_view> keys) const {
    for (const auto& [key, node] : table_) {
      if (std::ranges::find(keys, key.str()) == keys.end()) {
        throw Wrong(place(std::string(key.str()).c_str()) + " is not known; docs/gaits.md lists the keys");
      }
    }
  }
  void know(std::initializer_list<std::string_view> keys, std::span<const char* const> more = {}) const {
    std::vector<std::string_view> all(keys);
    all.insert(all.end(), more.begin(), more.end());
    know(all);
  }

  [[nodiscard]] Table table(const char* key, Numbers allowed = Numbers::finite) const {
    const toml::table* inner = table_.get_as<toml::table>(key);
    if (inner == nullptr) throw Wrong("the table [" + std::string(key) + "] is missing");
    return {*inner, key, allowed};
  }

  [[nodiscard]] const toml::table& raw() const { return table_; }

 private:
  [[nodiscard]] bool allows(double value) const { return allowed_ == Numbers::any || std::isfinite(value); }
  [[nodiscard]] std::string place(const char* key) const { return name_.empty() ? key : name_ + "." + key; }

  const toml::table& table_;
  std::string name_;
  Numbers allowed_;
};

gait::GaitOutputs read_outputs(const Table& table) {
  gait::GaitOutputs outputs;
  const bool by_time = table.word("phase", {"time", "hip_position"}) == "time";
  outputs.phase = by_time ? gait::PhaseKind::time : gait::PhaseKind::hip_position;
  const char* start_key = by_time ? "phase_start_s" : "phase_start_m";
  const char* end_key = by_time ? "phase_end_s" : "phase_end_m";
  table.know({"phase", start_key, end_key, "degree"}, kJointKeys);
  outputs.phase_start = table.number(start_key);
  outputs.phase_end = table.number(end_key);
  if (outputs.phase_start == outputs.phase_end || (by_time && outputs.phase_end < outputs.phase_start)) {
    throw Wrong(by_time ? "outputs.phase_end_s must be later than phase_start_s"
                        : "outputs.phase_end_m must differ from phase_start_m");
  }
  outputs.degree = table.integer("degree", gait::kMinOutputDegree, gait::kMaxOutputDegree);
  for (int j = 0; j < model::kJoints; ++j) {
    table.numbers(kJointKeys[j], {outputs.angle_rad[j], static_cast<std::size_t>(outputs.degree) + 1});
  }
  return outputs;
}

gait::OutputFeedback read_feedback(const Table& table) {
  table.know({"kp_1_s2", "kd_1_s", "placement"});
  gait::OutputFeedback feedback;
  feedback.kp_1_s2 = table.number("kp_1_s2");
  feedback.kd_1_s = table.number("kd_1_s");
  if (feedback.kp_1_s2 <= 0.0 || feedback.kd_1_s <= 0.0) {
    throw Wrong("feedback.kp_1_s2 and kd_1_s must be above 0");
  }
  if (table.has("placement")) table.numbers("placement", feedback.placement);
  return feedback;
}

gait::GaitMotion read_motion(const Table& states, const Table& inputs) {
  states.know({"degree"}, kPositionKeys);
  std::vector<const char*> input_keys(std::begin(kTorqueKeys), std::end(kTorqueKeys));
  input_keys.insert(input_keys.end(), std::begin(kForceKeys), std::end(kForceKeys));
  inputs.know({}, input_keys);
  gait::GaitMotion motion;
  motion.degree = states.integer("degree", 2, gait::kMaxMotionDegree);
  const auto count = static_cast<std::size_t>(motion.degree) + 1;
  for (int i = 0; i < model::kPositions; ++i) states.numbers(kPositionKeys[i], {motion.position[i], count});
  for (int j = 0; j < model::kJoints; ++j) inputs.numbers(kTorqueKeys[j], {motion.torque_Nm[j], count});
  for (int i = 0; i < 2; ++i) inputs.numbers(kForceKeys[i], {motion.force_N[i], count});
  return motion;
}

GaitRecord read(const Table& file, const std::filesystem::path& folder) {
  if (!file.has("format"))
    throw Wrong("is no gait file: format = 1 is missing; stilt gait synthesize writes one");
  GaitRecord record;
  (void)file.integer("format", 1, 1);
  file.know({"format", "robot", "speed_m_s", "step_time_s", "step_length_m", "origin", "limits", "claims",
             "outputs", "feedback", "states", "inputs"});
  record.robot = file.robot("robot", folder);
  gait::HzdGait& gait = record.gait;
  gait.outputs = read_outputs(file.table("outputs"));
  const bool by_time = gait.outputs.phase == gait::PhaseKind::time;
  const double phase_span = gait.outputs.phase_end - gait.outputs.phase_start;
  gait.step_time_s = file.number_or("step_time_s", by_time ? phase_span : 0.0);
  gait.step_length_m = file.number_or("step_length_m", by_time ? 0.0 : phase_span);
  gait.speed_m_s =
      file.number_or("speed_m_s", gait.step_time_s > 0.0 ? gait.step_length_m / gait.step_time_s : 0.0);
  if (gait.step_time_s < 0.0) throw Wrong("step_time_s must be above 0");
  if (file.has("feedback")) gait.feedback = read_feedback(file.table("feedback"));
  if (file.has("states") || file.has("inputs")) {
    gait.motion = read_motion(file.table("states"), file.table("inputs"));
    if (gait.step_time_s == 0.0) throw Wrong("step_time_s must be given with [states]");
  }
  if (file.has("limits")) file.table("limits").fields(limit_fields(), record.limits);
  if (file.has("claims")) {  // the largest eigenvalue of a gait that falls is infinite
    file.table("claims", Table::Numbers::any).fields(metric_fields(), record.claims.emplace());
  }
  if (file.has("origin")) {
    for (const auto& [key, node] : file.table("origin").raw()) {
      record.origin.emplace_back(key.str(), node.value<std::string>().value_or(""));
    }
  }
  return record;
}

}  // namespace

std::expected<GaitRecord, std::string> parse_gait(std::string_view toml, std::string_view file) {
  const std::string where = std::string(file) + ": ";
  try {
    const toml::table table = toml::parse(toml, file);
    return read(Table(table, ""), std::filesystem::path(file).parent_path());
  } catch (const toml::parse_error& error) {
    return std::unexpected(where + "line " + std::to_string(error.source().begin.line) +
                           " is not TOML: " + std::string(error.description()));
  } catch (const Wrong& wrong) {
    return std::unexpected(where + wrong.what());
  }
}

std::expected<GaitRecord, std::string> load_gait(const std::string& path) {
  const auto text = diagnostics::read_file(path);
  if (!text) {
    return std::unexpected(path + ": the gait file cannot be read (" + text.error() +
                           "); name an existing file");
  }
  return parse_gait(*text, path);
}

}  // namespace stilt::gait_files
