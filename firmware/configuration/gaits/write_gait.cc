#include <charconv>

#include "firmware/configuration/gaits/gait_file.h"
#include "firmware/configuration/gaits/gait_names.h"

namespace stilt::gait_files {
namespace {

/// Shortest text that reads back to the same number, as a TOML float.
std::string number(double value) {
  char text[40];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  std::string result(text, end);
  if (result.find_first_of(".en") == std::string::npos) result += ".0";
  return result;
}

std::string numbers(std::span<const double> values) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i) text += (i > 0 ? ", " : "") + number(values[i]);
  return text + "]";
}

class Writer {
 public:
  void comment(const std::string& text) { text_ += "# " + text + "\n"; }
  void table(const std::string& name, const std::string& meaning) {
    text_ += "\n[" + name + "]\n";
    if (!meaning.empty()) comment(meaning);
  }
  void word(const std::string& key, const std::string& value) {
    text_ += key + " = \"";
    for (const char c : value) text_ += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    text_ += "\"\n";
  }
  void integer(const std::string& key, int value) { text_ += key + " = " + std::to_string(value) + "\n"; }
  void value(const std::string& key, double value) { text_ += key + " = " + number(value) + "\n"; }
  void list(const std::string& key, const double* values, int count) {
    text_ += key + " = " + numbers({values, static_cast<std::size_t>(count)}) + "\n";
  }
  template <class T>
  void fields(std::span<const Field<T>> rows, T object) {
    for (const Field<T>& row : rows) {
      const std::span<double> values = row.values(object);
      text_ += std::string(row.key) + " = " + (values.size() == 1 ? number(values[0]) : numbers(values)) +
               "  # " + row.meaning + "\n";
    }
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void write_outputs(const gait::HzdGait& gait, Writer& writer) {
  const gait::GaitOutputs& outputs = gait.outputs;
  const bool by_time = outputs.phase == gait::PhaseKind::time;
  writer.table(
      "outputs",
      "joint angles as Bezier polynomials of the phase s = (now - start) / (end - start); now is the time "
      "since touch-down or the hip's position ahead of the stance foot");
  writer.word("phase", by_time ? "time" : "hip_position");
  writer.value(by_time ? "phase_start_s" : "phase_start_m", outputs.phase_start);
  writer.value(by_time ? "phase_end_s" : "phase_end_m", outputs.phase_end);
  writer.integer("degree", outputs.degree);
  for (int j = 0; j < model::kJoints; ++j)
    writer.list(kJointKeys[j], outputs.angle_rad[j], outputs.degree + 1);

  writer.table(
      "feedback",
      "output error e: e'' + kd e' + kp e = 0; the swing hip lands shifted by minus the gains on pitch, "
      "stance hip, stance knee, swing hip, swing knee and their rates just after the last touch-down");
  writer.value("kp_1_s2", gait.feedback.kp_1_s2);
  writer.value("kd_1_s", gait.feedback.kd_1_s);
  writer.list("placement", gait.feedback.placement, gait::kReducedStates);
}

void write_motion(const gait::GaitMotion& motion, Writer& writer) {
  const int count = motion.degree + 1;
  writer.table("states", "Bezier polynomials of time / step time; x and z of the hip from the stance foot");
  writer.integer("degree", motion.degree);
  for (int i = 0; i < model::kPositions; ++i) writer.list(kPositionKeys[i], motion.position[i], count);
  writer.table("inputs", "Bezier polynomials of time / step time, of the degree of the states");
  for (int j = 0; j < model::kJoints; ++j) writer.list(kTorqueKeys[j], motion.torque_Nm[j], count);
  for (int i = 0; i < 2; ++i) writer.list(kForceKeys[i], motion.force_N[i], count);
}

}  // namespace

std::string to_toml(const GaitRecord& record) {
  const gait::HzdGait& gait = record.gait;
  Writer writer;
  writer.comment(
      "One step of a periodic gait; docs/gaits.md describes the file. `stilt gait check` recomputes it.");
  writer.integer("format", 1);
  writer.word("robot", record.robot);
  writer.value("speed_m_s", gait.speed_m_s);
  writer.value("step_time_s", gait.step_time_s);
  writer.value("step_length_m", gait.step_length_m);
  if (!record.origin.empty()) writer.table("origin", "how it was made");
  for (const auto& [key, text] : record.origin) writer.word(key, text);
  writer.table("limits", "what the gait has to keep to");
  writer.fields(limit_fields(), record.limits);
  if (record.claims) {
    writer.table("claims", "what was computed when the file was written");
    writer.fields(metric_fields(), *record.claims);
  }
  write_outputs(gait, writer);
  if (gait.motion.degree > 0) write_motion(gait.motion, writer);
  return writer.text();
}

}  // namespace stilt::gait_files
