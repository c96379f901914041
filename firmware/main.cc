#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <expected>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "firmware/diagnostics/output_file.h"
#include "firmware/diagnostics/standard_streams.h"
#include "firmware/open_buses.h"
#include "firmware/program/commissioning_run.h"
#include "firmware/program/configure_controller.h"
#include "firmware/program/controller_state.h"
#include "firmware/program/found_values.h"
#include "firmware/program/instruction_sets.h"
#include "firmware/program/interrupt_priorities.h"
#include "firmware/program/interrupt_report.h"
#include "firmware/program/lockstep_run.h"
#include "firmware/program/options.h"
#include "firmware/program/outcome.h"
#include "firmware/program/realtime_run.h"
#include "firmware/program/report.h"
#include "firmware/program/self_test.h"
#include "firmware/program/terminal_person.h"
#include "firmware/telemetry/telemetry_node.h"
#include "firmware/version/commit.h"
#include "firmware/version/megabytes.h"

/// stiltd: reads the configuration, opens the buses, runs the controller, reports.
namespace {

using namespace stilt;

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kBadUsage = 2;
constexpr const char* kBusesRefused = "buses, drivers or joints cannot do this, see above";

/// All state of the controller.
program::ControllerState controller_state;

control_loop::StopSignals& stops = controller_state.mail.stops;

std::atomic<bool> print_asked = false;  ///< histograms so far

void want_stop(int) { stops.shut_down.store(true, std::memory_order_relaxed); }
void want_cut(int) {
  stops.cut.store(true, std::memory_order_relaxed);
  want_stop(0);
}
/// A second Ctrl-C cuts. One key press may arrive twice, from the terminal and from a wrapper: not that.
void want_stop_or_cut(int) {
  constexpr std::int64_t kOnePress_ns = 300'000'000;
  static std::int64_t first_ns = 0;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);  // may be called in a handler
  const std::int64_t now_ns = std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
  if (first_ns == 0) first_ns = now_ns;
  if (now_ns - first_ns > kOnePress_ns) return want_cut(0);
  want_stop(0);
}
void want_statistics(int) { print_asked.store(true, std::memory_order_relaxed); }

std::string version_text() {
  return "stiltd " STILT_VERSION "\ncommit            " + std::string(version::commit()) +
         "\ncompiler          GCC " __VERSION__ "\ninstruction set   " STILT_ISA ", " +
         program::planner_instruction_sets() + "\ncontroller object " +
         version::megabytes(sizeof controller_state);
}

int refuse(const std::string& sentence) {
  std::fprintf(stderr, "stiltd: %s\n", sentence.c_str());
  return kBadUsage;
}

std::string not_written(const std::string& option, const std::string& file, const std::string& reason) {
  return option + " " + file + ": cannot be written (" + reason + "); name a file in a writable folder";
}

/// Looks before the run whether its files can be written after it.
std::expected<void, std::string> check_files(const program::Options& options) {
  for (const auto& [option, file] : {std::pair<std::string, std::string>{"--json", options.json_file},
                                     {"--black-box", options.black_box_file},
                                     {"--out", options.out_file}}) {
    const std::string reason = diagnostics::why_not_writable(file);
    if (!reason.empty()) return std::unexpected(not_written(option, file, reason));
  }
  return {};
}

/// Results as JSON where they are asked for. False: they could not be written; standard error says why.
bool write_json(const program::Options& options, const std::string& json) {
  if (options.json_file.empty()) return true;
  const auto written = diagnostics::write_file(options.json_file, json);
  if (!written) static_cast<void>(refuse(not_written("--json", options.json_file, written.error())));
  return written.has_value();
}

/// Of a controller or command that does not begin; a self-test has the fields of one that fails.
std::string refusal_json(const program::Options& options, const std::string& sentence) {
  if (options.task != program::Task::self_test) return program::failure_json(sentence);
  program::SelfTestResult result;
  result.failure = sentence;
  return program::to_json(result);
}

/// Standard error has the reason, and so has the JSON where it is asked for and can be written.
int refuse(const program::Options& options, const std::string& sentence) {
  const bool has_its_place = program::file_conflict(options).empty();
  if (has_its_place && diagnostics::why_not_writable(options.json_file).empty()) {
    static_cast<void>(write_json(options, refusal_json(options, sentence)));
  }
  return refuse(sentence);
}

/// Looks at buses and machine before anything moves. The error is for the user.
/// @param machine  what it keeps of the machine holds as long as it lives
std::expected<void, std::string> check_start(const program::Options& options, program::Outcome& outcome,
                                             realtime::Capability& machine) {
  const program::BusReport buses = program::report_buses(options.configuration);
  std::fputs(buses.text.c_str(), stderr);
  if (buses.refused) return std::unexpected(kBusesRefused);
  if (options.lockstep) {
    outcome.not_realtime = "lock-step";
    return {};
  }
  machine = realtime::acquire(program::requirements_of(options.configuration.runtime));
  std::fputs(program::describe(machine).c_str(), stderr);
  const std::vector<realtime::BusInterrupts> interrupts =
      realtime::bus_interrupts(configuration::bus_names(options.configuration.hardware));
  for (const std::string& line : program::interrupt_sentences(interrupts)) {
    std::fprintf(stderr, "bus %s\n", line.c_str());
  }
  for (const std::string& line : program::delay_sentences(interrupts, options.configuration.runtime)) {
    std::fprintf(stderr, "stiltd: %s\n", line.c_str());
  }
  outcome.idle_states = program::idle_text(machine);
  outcome.not_realtime = realtime::lacking_text(machine);
  if (!machine.realtime() && program::requires_realtime(options.configuration)) {
    return std::unexpected(
        "runtime.require_realtime is true and this machine cannot keep time, see above; mend that, or set it "
        "to false");
  }
  return {};
}

int report(const program::Options& options, const program::Outcome& outcome) {
  if (!outcome.error.empty()) std::fprintf(stderr, "stiltd: %s\n", outcome.error.c_str());
  if (!outcome.not_written.empty()) std::fprintf(stderr, "stiltd: %s\n", outcome.not_written.c_str());
  const bool results_written = write_json(options, program::to_json(outcome));
  if (!results_written || !outcome.not_written.empty()) return kBadUsage;
  return outcome.error.empty() && outcome.last_state != "fault" ? kDone : kFailed;
}

/// Opens the buses and puts the controller together over them.
std::expected<void, std::string> connect(const program::Options& options, std::vector<hal::AnyBus>& buses) {
  const Received received =
      options.task == program::Task::scan ? Received::all : Received::those_of_the_wiring;
  // Above the planner, that no solve delays it, and below the torque loop.
  const int priority = std::max(options.configuration.runtime.torque_priority - 1, 0);
  auto opened = open_buses(options.configuration.hardware, options.lockstep, received, priority);
  if (!opened) return std::unexpected(opened.error());
  buses = std::move(*opened);
  std::vector<hal::FrameBus*> frames;
  for (hal::AnyBus& bus : buses) frames.push_back(&bus.frames());
  if (const auto ready = program::set_up(options, frames, controller_state); !ready) return ready;
  controller_state.reconnect = [&buses](std::size_t bus) { static_cast<void>(buses[bus].reconnect()); };
  std::signal(SIGINT, want_stop_or_cut);
  std::signal(SIGTERM, want_stop);
  std::signal(SIGHUP, want_stop);  // the terminal is gone
  // Keys beside Ctrl-C, and jobs in the background: a program that the kernel stops leaves its motors with
  // torque.
  std::signal(SIGQUIT, want_cut);
  std::signal(SIGTSTP, want_stop);
  std::signal(SIGTTIN, SIG_IGN);
  std::signal(SIGTTOU, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);  // who read the output is gone: no reason to fall
  std::signal(SIGUSR1, want_statistics);
  return {};
}

/// After the last tick: commands that drivers without power would get later.
void say_unacknowledged(std::vector<hal::AnyBus>& buses) {
  for (const std::string& sentence : unacknowledged(buses)) {
    std::fprintf(stderr, "stiltd: %s\n", sentence.c_str());
  }
}

/// Telemetry begins before memory is locked: what its threads never use needs none.
std::expected<std::unique_ptr<telemetry::TelemetryNode>, std::string> open_telemetry(
    const program::Options& options) {
  if (!options.configuration.telemetry.enabled) return nullptr;
  // One heap for all threads, which keeps what it has: nothing is given back while the robot runs.
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_MMAP_THRESHOLD, 32 * 1024 * 1024);  // the most that glibc takes
  const telemetry::RunDescription run{
      STILT_VERSION,
      "GCC " __VERSION__,
      STILT_ISA ", planner " + std::string(name_of(options.configuration.sqp.instruction_set)),
      options.lockstep,
      options.lockstep ? "lock-step" : "",
      "",
      options.source};
  auto node = telemetry::TelemetryNode::open(options.configuration, run, controller_state.mail);
  if (!node) return std::unexpected(node.error() + "; or set telemetry.enabled to false");
  return node;
}

/// Once the buses are open: a controller that cannot start leaves every token as it is.
std::expected<void, std::string> take_commands(const program::Options& options,
                                               telemetry::TelemetryNode& node) {
  if (const auto taken = node.take_commands(); !taken) return taken;
  const configuration::TelemetryParameters& parameters = options.configuration.telemetry;
  const std::string security = parameters.security_folder == "none"
                                   ? ""
                                   : ", encrypted by DDS Security with " + parameters.security_folder;
  std::fprintf(stderr, "telemetry on %s, domain %d%s; token in %s\n", parameters.interface.c_str(),
               parameters.domain, security.c_str(), node.token_file().c_str());
  return {};
}

int run_controller(const program::Options& options) {
  program::Outcome outcome;
  outcome.started = program::utc_now();
  outcome.commit = version::commit();
  realtime::Capability machine;
  std::vector<hal::AnyBus> buses;
  if (const auto writable = check_files(options); !writable) return refuse(options, writable.error());
  const auto node = open_telemetry(options);
  if (!node) return refuse(options, node.error());
  if (const auto fit = check_start(options, outcome, machine); !fit) return refuse(options, fit.error());
  if (const auto connected = connect(options, buses); !connected) return refuse(options, connected.error());
  if (*node) {
    if (const auto taken = take_commands(options, **node); !taken) return refuse(options, taken.error());
  }
  controller_state.telemetry_node = node->get();
  if (*node) {
    (*node)->set_not_realtime(outcome.not_realtime);
    outcome.run_id = (*node)->run_id();
  }
  if (options.lockstep) {
    program::run_lockstep(options, buses.size(), controller_state, outcome);
  } else {
    program::run_realtime(options, print_asked, controller_state, outcome);
  }
  say_unacknowledged(buses);
  program::take_statistics(controller_state, outcome);
  if (!stops.shut_down.load()) program::check_goal(options, controller_state, outcome);
  return report(options, outcome);
}

int run_self_test(const program::Options& options) {
  program::Outcome outcome;
  realtime::Capability machine;
  std::vector<hal::AnyBus> buses;
  if (const auto writable = check_files(options); !writable) return refuse(options, writable.error());
  if (const auto fit = check_start(options, outcome, machine); !fit) return refuse(options, fit.error());
  if (const auto connected = connect(options, buses); !connected) return refuse(options, connected.error());
  const program::SelfTestResult result =
      program::run_self_test(options, controller_state, stops.shut_down, machine.idle.held());
  say_unacknowledged(buses);
  if (options.json_file != "-") std::fputs(program::to_text(result).c_str(), stdout);
  if (!write_json(options, program::to_json(result))) return kBadUsage;
  return result.passed() ? kDone : kFailed;
}

/// Commands that give a joint torque need what the controller needs: frames that carry its angles and
/// torques.
std::expected<void, std::string> check_buses(const program::Options& options) {
  if (!program::gives_torque(options.task)) return {};
  const program::BusReport buses = program::report_buses(options.configuration);
  if (!buses.refused) return {};
  std::fputs(buses.text.c_str(), stderr);
  return std::unexpected(kBusesRefused);
}

/// scan, watch, jog, zero, calibrate, identify: no torque loop, and no machine that must keep time. jog and
/// identify end limp once their own loop has stood still.
int run_commissioning(const program::Options& options) {
  std::vector<hal::AnyBus> buses;
  if (const auto writable = check_files(options); !writable) return refuse(options, writable.error());
  if (const auto fit = check_buses(options); !fit) return refuse(options, fit.error());
  if (const auto fit = program::check_out_file(options); !fit) return refuse(options, fit.error());
  auto person = program::TerminalPerson::open(options.answers_file);
  if (!person) return refuse(options, person.error());
  if (const auto connected = connect(options, buses); !connected) return refuse(options, connected.error());
  std::unique_ptr<telemetry::TelemetryNode> node;
  if (options.task == program::Task::watch) {
    auto opened = open_telemetry(options);
    if (!opened) return refuse(options, opened.error());
    node = std::move(*opened);
    if (node) {
      if (const auto taken = take_commands(options, *node); !taken) return refuse(options, taken.error());
    }
    controller_state.telemetry_node = node.get();
  }
  const program::CommissioningOutcome outcome =
      program::run_commissioning(options, controller_state, stops.shut_down, *person);
  say_unacknowledged(buses);
  if (options.json_file != "-") std::fputs(outcome.text.c_str(), stdout);
  const bool reported = outcome.json.empty() || write_json(options, outcome.json);
  if (!outcome.error.empty()) {
    std::fprintf(stderr, "stiltd: %s\n", outcome.error.c_str());
    return outcome.bad_input ? kBadUsage : kFailed;
  }
  if (!reported) return kBadUsage;
  return outcome.passed ? kDone : kFailed;
}

/// --print-config, for a file in the working directory.
int print_config(configuration::Configuration configuration) {
  configuration.hardware.robot = configuration::robot_in_file("", configuration.hardware.robot);
  std::fputs(configuration::to_toml(configuration, "Configuration of the controller.").c_str(), stdout);
  return kDone;
}

/// --check-config: the configuration was read; what it means here.
int check_config(const program::Options& options) {
  const program::BusReport buses = program::report_buses(options.configuration);
  const auto controller =
      program::configure_controller(options.configuration, options.source, controller_state.planner,
                                    controller_state.control, &controller_state.gaits);
  if (!controller) return refuse(controller.error());
  std::printf("%s: %s\nrobot %s\n%s%s", options.source.c_str(),
              buses.refused ? "each key is valid, and buses, drivers or joints cannot do it" : "valid",
              options.configuration.hardware.robot.c_str(),
              program::robot_text(options.configuration).c_str(), buses.text.c_str());
  return buses.refused ? kBadUsage : kDone;
}

/// interrupts: of the buses that were named, or of the configuration's, but those without hardware.
int run_interrupts(const program::Options& options) {
  const std::vector<std::string>& named = options.interrupt_buses;
  std::vector<realtime::BusInterrupts> buses = realtime::bus_interrupts(
      named.empty() ? configuration::bus_names(options.configuration.hardware) : named);
  if (named.empty()) {
    std::erase_if(buses,
                  [](const auto& bus) { return bus.adapter.empty() && program::may_lack_adapter(bus.bus); });
  }
  const auto raised = program::raise_interrupts(buses, options.configuration.runtime);
  if (!raised) return refuse("interrupts: " + raised.error());
  std::fputs(raised->c_str(), stdout);
  return kDone;
}

int run(const program::Options& options) {
  switch (options.task) {
    case program::Task::nothing:
      return kDone;
    case program::Task::print_config:
      return print_config(options.configuration);
    case program::Task::check_config:
      return check_config(options);
    case program::Task::interrupts:
      return run_interrupts(options);
    case program::Task::self_test:
      return run_self_test(options);
    case program::Task::scan:
    case program::Task::watch:
    case program::Task::jog:
    case program::Task::zero:
    case program::Task::calibrate:
    case program::Task::identify:
      return run_commissioning(options);
    case program::Task::control:
      break;
  }
  return run_controller(options);
}

}  // namespace

int main(int argc, char** argv) {
  if (!diagnostics::keep_standard_streams()) return kBadUsage;
  program::Options options;
  if (const auto read = program::read_options(argc, argv, version_text(), options); !read) {
    return refuse(options, read.error());
  }
  const std::string conflict = program::file_conflict(options);
  if (!conflict.empty()) return refuse(conflict);
  const int status = run(options);
  return status == kBadUsage || diagnostics::all_printed() ? status : refuse(diagnostics::kNotPrinted);
}
