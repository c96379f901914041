#include <charconv>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/control_loop/joint_names.h"
#include "host_tools/recording/record/tick_ledger.h"
#include "host_tools/recording/run/text_run.h"
#include "host_tools/recording/run/tick_run.h"

namespace stilt::record {
namespace {

using control_loop::TickRecord;

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

template <class Number>
bool read(std::string_view cell, Number& number) {
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  return error == std::errc{} && end == cell.data() + cell.size();
}

std::optional<supervisor::State> state_of(std::string_view name) {
  for (std::size_t i = 0; i < supervisor::kStates; ++i) {
    const auto state = static_cast<supervisor::State>(i);
    if (name == supervisor::name(state)) return state;
  }
  return std::nullopt;
}

/// Reads lines of ticks by the names of their columns.
class TickReader {
 public:
  /// Throws std::runtime_error when a column is missing.
  TickReader(const std::string& path, std::string_view header) : path_(path) {
    const std::vector<std::string_view> names = cells_of(header);
    columns_ = names.size();
    for (std::size_t i = 0; i < columns_; ++i) index_.emplace(names[i], i);
    tick_ = column("tick");
    time_ = column("time_s");
    state_ = column("state");
    faults_ = column("faults");
    plan_sequence_ = column("plan_sequence");
    for (std::size_t i = 0; i < hal::kJoints; ++i) {
      const std::string joint = control_loop::kJointNames[i];
      numbers_.push_back({column(joint + "_velocity_rad_s"),
                          [i](TickRecord& t) -> double& { return t.joints[i].velocity_rad_s; }});
      numbers_.push_back(
          {column(joint + "_torque_Nm"), [i](TickRecord& t) -> double& { return t.joints[i].torque_Nm; }});
      add_state(3 + i, joint + "_rad");
      add_state(10 + i, joint + "_rad_s");
    }
    for (const auto& [row, name] : {std::pair<std::size_t, const char*>{0, "x_b_m"},
                                    {1, "z_b_m"},
                                    {2, "pitch_b_rad"},
                                    {7, "x_b_m_s"},
                                    {8, "z_b_m_s"},
                                    {9, "pitch_b_rad_s"}}) {
      add_state(row, name);
    }
    numbers_.push_back(
        {column("left_foot_force_N"), [](TickRecord& t) -> double& { return t.base.left_foot_force_N; }});
    numbers_.push_back(
        {column("right_foot_force_N"), [](TickRecord& t) -> double& { return t.base.right_foot_force_N; }});
  }

  /// The tick of a line, nothing when the line is cut off or has a wrong value. `faults`: their names.
  std::optional<TickRecord> read_line(std::string_view line, std::string& faults) const {
    const std::vector<std::string_view> cells = cells_of(line);
    if (cells.size() != columns_) return std::nullopt;
    TickRecord tick;
    double time_s = 0.0;
    const auto state = state_of(cells[state_]);
    if (!read(cells[tick_], tick.tick) || !read(cells[time_], time_s) || !state) return std::nullopt;
    if (!read(cells[plan_sequence_], tick.plan_sequence)) return std::nullopt;
    for (const auto& [column, member] : numbers_) {
      if (!read(cells[column], member(tick))) return std::nullopt;
    }
    tick.time_ns = std::llround(1e9 * time_s);
    tick.state = *state;
    const bool on_its_feet = *state >= supervisor::State::stand && *state <= supervisor::State::walk;
    tick.stance_episode = on_its_feet ? 1 : 0;
    tick.gait = {gait::GaitKind::walk, std::numeric_limits<double>::quiet_NaN()};  // no column has it
    faults = cells[faults_];
    return tick;
  }

 private:
  struct NumberColumn {
    std::size_t column;
    std::function<double&(TickRecord&)> member;
  };

  std::size_t column(const std::string& name) const {
    const auto found = index_.find(name);
    if (found != index_.end()) return found->second;
    throw std::runtime_error(path_ + ": has no column " + name +
                             "; name a file of stiltd --black-box or the ticks of stilt log csv");
  }

  void add_state(std::size_t row, const std::string& name) {
    numbers_.push_back(
        {column("estimated_" + name), [row](TickRecord& t) -> double& { return t.estimated_state[row]; }});
  }

  std::string path_;
  std::map<std::string, std::size_t, std::less<>> index_;
  std::size_t columns_ = 0, tick_ = 0, time_ = 0, state_ = 0, faults_ = 0, plan_sequence_ = 0;
  std::vector<NumberColumn> numbers_;
};

std::string event_text(const TickRecord& tick, const std::string& faults) {
  return std::string("state ") + supervisor::name(tick.state) + (faults.empty() ? "" : ", faults " + faults);
}

/// One of the runs in a file.
class FileRun {
 public:
  explicit FileRun(const model::RobotConstants& robot) : ticks_(robot, 0, no_plans_, run_) {
    run_.controller.emplace();
  }

  /// Whether the tick is of another run: in one run, neither number nor time fall.
  [[nodiscard]] bool ends_before(const TickRecord& tick) const {
    return count_ > 0 && (tick.tick < last_tick_ || tick.time_ns < last_ns_);
  }

  void add(const TickRecord& tick, const std::string& faults) {
    ticks_.add(tick);
    std::string event = event_text(tick, faults);
    if (event != said_) run_.controller->events.push_back({1e-9 * static_cast<double>(tick.time_ns), event});
    said_ = std::move(event);
    last_tick_ = tick.tick;
    last_ns_ = tick.time_ns;
    ++count_;
    ledger_.add(tick.tick, 1);
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] const TickLedger& ledger() const { return ledger_; }

  /// Call once, after the last tick.
  log::RunRecord finish() {
    ticks_.finish();
    return std::move(run_);
  }

 private:
  PlanTrack no_plans_;
  log::RunRecord run_;
  TickRun ticks_;
  std::string said_;
  std::uint64_t last_tick_ = 0;
  std::int64_t last_ns_ = 0;
  std::size_t count_ = 0;
  TickLedger ledger_;
};

}  // namespace

RecordRun run_of_ticks(const std::string& path, const model::RobotConstants& robot) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  const TickReader reader(path, line);
  RecordRun result;
  result.robot = robot;
  auto longest = std::make_unique<FileRun>(robot);
  auto current = std::make_unique<FileRun>(robot);
  int number = 1;
  while (std::getline(file, line)) {
    ++number;
    std::string faults;
    const std::optional<TickRecord> tick = reader.read_line(line, faults);
    if (!tick) {
      result.problems.push_back(path + ": line " + std::to_string(number) +
                                " is no tick of stiltd; the report ends before it");
      break;
    }
    if (current->ends_before(*tick)) {
      ++result.runs;
      if (current->count() > longest->count()) std::swap(current, longest);
      current = std::make_unique<FileRun>(robot);
    }
    current->add(*tick, faults);
  }
  if (current->count() > longest->count()) std::swap(current, longest);
  if (longest->count() == 0) {
    throw std::runtime_error(path + ": holds no tick; name a file of stiltd --black-box");
  }
  if (longest->ledger().has_break()) {
    result.problems.push_back(path + ": " + longest->ledger().text_of_breaks() + kBreakInPlots);
  }
  result.run = longest->finish();
  result.run.robot.name = robot.name;
  result.run.command_line = path + ", ticks of stiltd, drawn as " + robot.name;
  return result;
}

}  // namespace stilt::record
