#include <atomic>
#include <csignal>
#include <cstdio>
#include <string>
#include <vector>

#include "firmware/open_buses.h"
#include "firmware/program/controller_state.h"
#include "firmware/program/lockstep_run.h"
#include "firmware/program/options.h"
#include "firmware/program/outcome.h"
#include "mpc_core/model/batch.h"

/// stiltd: reads the configuration, opens the buses, runs the controller, reports.
namespace {

using namespace stilt;

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kBadUsage = 2;

/// All state of the controller.
program::ControllerState controller_state;

std::atomic<bool> stop_wanted = false;

void want_stop(int) { stop_wanted.store(true, std::memory_order_relaxed); }

std::string version_text() {
  return "stiltd " STILT_VERSION "\ncompiler          GCC " __VERSION__ "\ninstruction set   " STILT_ISA
         ", " +
         std::to_string(model::kLanes) + " lanes\ncontroller object " +
         std::to_string(sizeof controller_state) + " bytes";
}

int refuse(const std::string& sentence) {
  std::fprintf(stderr, "stiltd: %s\n", sentence.c_str());
  return kBadUsage;
}

int run_controller(const program::Options& options) {
  auto buses = open_buses(options.configuration.hardware, options.lockstep);
  if (!buses) return refuse(buses.error());
  std::vector<hal::FrameBus*> frames;
  for (hal::AnyBus& bus : *buses) frames.push_back(&bus.frames());
  if (const auto ready = program::set_up(options, frames, controller_state); !ready) {
    return refuse(ready.error());
  }
  std::signal(SIGINT, want_stop);
  std::signal(SIGTERM, want_stop);
  program::Outcome outcome;
  program::run_lockstep(options, buses->size(), stop_wanted, controller_state, outcome);
  program::take_figures(controller_state, outcome);
  if (!outcome.error.empty()) std::fprintf(stderr, "stiltd: %s\n", outcome.error.c_str());
  if (!options.json_file.empty() && !program::write_text(program::to_json(outcome), options.json_file)) {
    return refuse("--json " + options.json_file + ": cannot be written; name a file in a folder that exists");
  }
  return outcome.error.empty() && outcome.last_state != "fault" ? kDone : kFailed;
}

}  // namespace

int main(int count, char** words) {
  const auto options = program::read_options(count, words, version_text());
  if (!options) return refuse(options.error());
  switch (options->task) {
    case program::Task::nothing:
      return kDone;
    case program::Task::print_config:
      std::fputs(configuration::to_toml(options->configuration, "Configuration of the controller.").c_str(),
                 stdout);
      return kDone;
    case program::Task::check_config:
    case program::Task::self_test:
    case program::Task::control:
      break;
  }
  return run_controller(*options);
}
