#include "firmware/program/commissioning_run.h"

#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "firmware/commissioning/calibrate.h"
#include "firmware/commissioning/identify.h"
#include "firmware/commissioning/jog_dialog.h"
#include "firmware/commissioning/json_text.h"
#include "firmware/commissioning/scan.h"
#include "firmware/commissioning/unknown_turns.h"
#include "firmware/commissioning/watch.h"
#include "firmware/commissioning/zero.h"
#include "firmware/configuration/driver_of.h"
#include "firmware/program/commissioning_requests.h"
#include "firmware/program/found_values.h"
#include "firmware/program/torso_sensor_report.h"
#include "firmware/program/watch_telemetry.h"
#include "firmware/realtime/thread.h"
#include "firmware/robots/robots.h"

// What a person does before the controller runs: docs/decisions/0021-commissioning.md
namespace stilt::program {
namespace {

using commissioning::Session;

std::int64_t tick_ns(const Options& options) {
  return std::llround(1e9 / options.configuration.timing.torque_rate_hz);
}

/// Once the drivers are up.
void say_unknown_turns(const ControllerState& state) {
  const std::string sentence = commissioning::unknown_turns(*state.hardware);
  if (!sentence.empty()) std::fprintf(stderr, "stiltd: %s\n", sentence.c_str());
}

Session session_of(const Options& options, ControllerState& state, hal::Clock& clock,
                   const std::atomic<bool>& stop) {
  return {*state.hardware, clock, tick_ns(options), stop, driver_limits(options)};
}

CommissioningOutcome failed(const std::string& error, bool bad_input = false) {
  return {.error = error, .bad_input = bad_input, .text = {}, .json = failure_json(error)};
}

/// Why the torso sensor on a serial port does not report; empty: it does. It is known after half a second.
std::string serial_trouble(torso_sensor::SerialTorsoSensor& sensor, hal::Clock& clock) {
  constexpr int kMostSteps = 1000;
  constexpr std::int64_t kStep_ns = 1'000'000;
  for (int step = 0; step < kMostSteps && sensor.newest().number == 0; ++step) {
    if (sensor.trouble() != torso_sensor::SerialTrouble::none) break;
    static_cast<void>(clock.sleep_until(clock.now_ns() + kStep_ns));
  }
  return sensor.trouble_sentence();
}

CommissioningOutcome run_scan(const Options& options, ControllerState& state, hal::Clock& clock,
                              const std::atomic<bool>& stop) {
  std::vector<hal::FrameBus*> buses;
  for (hal::TapBus& bus : state.hardware->buses()) buses.push_back(&bus);
  const configuration::HardwareParameters& hardware = options.configuration.hardware;
  const auto robot = robots::find(hardware.robot);
  if (!robot) return failed(robot.error(), true);
  auto result =
      commissioning::scan(hardware, wanted_of_drivers(options, (*robot)->model), buses, clock, stop);
  if (options.configuration.hardware.torso_sensor.device == configuration::TorsoDevice::vectornav) {
    result.serial_sensor_trouble = serial_trouble(state.serial_torso_sensor, clock);
  }
  return {.error = {}, .passed = result.complete(), .text = to_text(result), .json = to_json(result)};
}

/// A table that is drawn over the one before on a terminal, lines of JSON elsewhere.
class WatchDisplay {
 public:
  /// @param json_file  "-": standard output; empty: none
  explicit WatchDisplay(const std::string& json_file) : json_file_(json_file) {
    if (json_file == "-") json_ = stdout;
    if (!json_file.empty() && json_file != "-") {
      lines_.reset(std::fopen(json_file.c_str(), "we"));
      json_ = lines_.get();
      note(json_ != nullptr);
    }
  }

  void show(const commissioning::WatchSample& sample) {
    if (json_ != nullptr) put(commissioning::to_json_line(sample));
    last_ = commissioning::to_table(sample);
    if (json_ == stdout || !redraws_) return;
    if (drawn_) std::printf("\x1b[%dA\x1b[J", commissioning::kWatchLines);
    std::fputs(last_.c_str(), stdout);
    std::fflush(stdout);
    drawn_ = true;
  }

  /// The last line of JSON of a watch that could not go on.
  void fail(const std::string& error) {
    if (json_ != nullptr) put(failure_json(error));
  }

  /// Whether the lines of JSON have gone out so far.
  [[nodiscard]] bool good() const { return reason_.empty(); }

  /// At the end: why lines of JSON are lost, one sentence for the user; empty: none is.
  [[nodiscard]] std::string finish() {
    if (lines_) note(std::fclose(lines_.release()) == 0);
    if (good()) return "";
    return "--json " + json_file_ + ": cannot be written (" + reason_ + "); name a file in a writable folder";
  }

  /// The table of the end, where nothing was drawn.
  [[nodiscard]] std::string last() const { return redraws_ ? "" : last_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void put(const std::string& line) { note(std::fputs(line.c_str(), json_) >= 0 && std::fflush(json_) == 0); }
  void note(bool done) {
    if (!done && good()) reason_ = std::strerror(errno);
  }

  std::string json_file_;
  std::unique_ptr<std::FILE, Close> lines_;
  std::FILE* json_ = nullptr;
  std::string reason_;  ///< of the first line that is lost
  bool redraws_ = isatty(STDOUT_FILENO) == 1;
  bool drawn_ = false;
  std::string last_;
};

/// Ends when its lines of JSON are lost, too. The sample that it shows last is judged.
CommissioningOutcome run_watch(const Options& options, ControllerState& state, hal::Clock& clock,
                               const std::atomic<bool>& stop) {
  WatchDisplay display(options.json_file);
  if (!display.good()) return {.error = display.finish(), .bad_input = true, .text = {}, .json = {}};
  Session session = session_of(options, state, clock, stop);
  WatchTelemetry telemetry(state, clock.now_ns(), options.configuration.timing.torque_rate_hz);
  bool well = false;
  const auto show = [&](const commissioning::WatchSample& sample) {
    well = good(sample);
    if (sample.time_s == 0) say_unknown_turns(state);
    display.show(sample);
  };
  const auto done = commissioning::watch(session, options.duration_s, show, [&](const auto& sample) {
    return telemetry.follow(sample) && display.good();
  });
  if (!done) {
    display.fail(done.error());
    return {.error = done.error(), .text = {}, .json = {}};
  }
  const std::string lost = display.finish();
  return {.error = lost,
          .bad_input = !lost.empty(),
          .passed = lost.empty() && well,
          .text = display.last(),
          .json = {}};
}

CommissioningOutcome run_jog(const Options& options, ControllerState& state, hal::Clock& clock,
                             const std::atomic<bool>& stop, TerminalPerson& person) {
  const configuration::Configuration& configuration = options.configuration;
  const auto robot = robots::find(configuration.hardware.robot);
  if (!robot) return failed(robot.error(), true);
  const configuration::DriverParameters& driver =
      configuration::driver_of(configuration.hardware, options.joint);
  Session session = session_of(options, state, clock, stop);
  const commissioning::JogRequest request = jog_request(options, (*robot)->model);
  const auto report = commissioning::jog_and_ask(session, request, driver, person);
  if (!report) return failed(report.error().sentence, report.error().bad_answer);
  return {.error = {},
          .passed = report->verdict.finding == commissioning::Finding::correct,
          .text = to_text(*report),
          .json = to_json(*report)};
}

CommissioningOutcome run_zero(const Options& options, ControllerState& state, hal::Clock& clock,
                              const std::atomic<bool>& stop) {
  const configuration::HardwareParameters& hardware = options.configuration.hardware;
  const auto bus = static_cast<std::size_t>(hardware.joint[options.joint].bus);
  const auto report =
      commissioning::set_zero(hardware, options.joint, state.hardware->buses()[bus], clock, stop);
  if (!report) return failed(report.error().sentence, report.error().bad_answer);
  return {.error = {}, .passed = report->good(), .text = to_text(*report), .json = to_json(*report)};
}

/// The outcome of a command that has found values, which are written where that is asked for. What was found
/// is reported also when it cannot be written.
template <class Report>
CommissioningOutcome written(const Options& options, const Report& report, bool passed) {
  CommissioningOutcome outcome{.error = {}, .passed = passed, .text = to_text(report), .json = {}};
  bool writes = !report.values.empty() && !options.out_file.empty();
  if (writes) {
    if (const auto done = write_values(options, report.values); !done) {
      outcome.error = done.error();
      outcome.bad_input = true;
      writes = false;
    }
  }
  if (writes) outcome.text += written_text(options);
  outcome.json = to_json(report, writes ? options.out_file : "");
  if (!outcome.error.empty()) {
    auto json = nlohmann::ordered_json::parse(outcome.json);
    json["error"] = outcome.error;
    outcome.json = commissioning::json_text(json);
  }
  return outcome;
}

/// Angles of the joints' travel, and the like.
hal::JointValues joint_values(const double (&values)[model::kJoints]) { return std::to_array(values); }

CommissioningOutcome run_calibrate(const Options& options, ControllerState& state, hal::Clock& clock,
                                   const std::atomic<bool>& stop, TerminalPerson& person) {
  const auto robot = robots::find(options.configuration.hardware.robot);
  if (!robot) return failed(robot.error(), true);
  const model::RobotConstants& constants = (*robot)->model.constants;
  Session session = session_of(options, state, clock, stop);
  const commissioning::CalibrationRequest request{.reference = options.reference,
                                                  .hardware = options.configuration.hardware,
                                                  .minimum_rad = joint_values(constants.position_min_rad),
                                                  .maximum_rad = joint_values(constants.position_max_rad)};
  const auto report = commissioning::calibrate(session, request, person);
  if (!report) return failed(report.error().sentence, report.error().bad_answer);
  return written(options, *report, report->good());
}

CommissioningOutcome run_identify(const Options& options, ControllerState& state, hal::Clock& clock,
                                  const std::atomic<bool>& stop) {
  const auto robot = robots::find(options.configuration.hardware.robot);
  if (!robot) return failed(robot.error(), true);
  Session session = session_of(options, state, clock, stop);
  const commissioning::IdentificationRequest request = identification_request(options, (*robot)->model);
  const auto report = commissioning::identify(session, request);
  if (!report) return failed(report.error());
  return written(options, *report, report->findings.empty());
}

}  // namespace

std::string failure_json(const std::string& error) {
  return commissioning::json_text({{"good", false}, {"error", error}}, commissioning::kOneLine);
}

CommissioningOutcome run_commissioning(const Options& options, ControllerState& state,
                                       const std::atomic<bool>& stop, TerminalPerson& person) {
  CommissioningOutcome outcome;
  const auto ran = run_with_clock(options, state, [&](hal::Clock& clock) {
    if (options.task == Task::scan) outcome = run_scan(options, state, clock, stop);
    if (options.task == Task::watch) outcome = run_watch(options, state, clock, stop);
    if (options.task == Task::jog) outcome = run_jog(options, state, clock, stop, person);
    if (options.task == Task::zero) outcome = run_zero(options, state, clock, stop);
    if (options.task == Task::calibrate) outcome = run_calibrate(options, state, clock, stop, person);
    if (options.task == Task::identify) outcome = run_identify(options, state, clock, stop);
  });
  if (options.task != Task::watch) say_unknown_turns(state);
  TorsoSensorReport(options).update(state);
  return ran ? outcome : failed(ran.error());
}

std::expected<void, std::string> run_with_clock(const Options& options, ControllerState& state,
                                                const std::function<void(hal::Clock&)>& work) {
  if (options.lockstep) {
    constexpr double kPatience_s = 10.0;
    const std::size_t buses = configuration::bus_names(options.configuration.hardware).size();
    hal::LockstepClock clock(std::span(state.lockstep_buses).first(buses), tick_ns(options), kPatience_s);
    if (!clock.open()) {
      return std::unexpected(
          "the simulated robot does not answer in lock-step; start it with --lockstep too");
    }
    work(clock);
    static_cast<void>(clock.sleep_until(clock.now_ns() + 1));  // what was sent last is received
    return {};
  }
  const configuration::RuntimeParameters& runtime = options.configuration.runtime;
  realtime::Thread thread;
  auto body = [&work] {
    hal::MonotonicClock clock;
    work(clock);
  };
  const auto call = [](void* context) { (*static_cast<decltype(body)*>(context))(); };
  if (!thread.start({"commissioning", runtime.torque_priority, runtime.torque_core}, call, &body)) {
    return std::unexpected("no thread can be started");
  }
  const std::string refused = thread.refused();
  if (gives_torque(options.task) && !refused.empty())
    std::fprintf(stderr, "not real time: %s\n", refused.c_str());
  thread.join();
  return {};
}

}  // namespace stilt::program
