#include "host_tools/cli/closed_loop_bench.h"

#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

#include "host_tools/benchmark/plan_sample.h"
#include "host_tools/benchmark/planner_kernels.h"
#include "host_tools/cli/json_output.h"
#include "host_tools/cli/planning_problems.h"
#include "host_tools/cli/usage_error.h"

namespace stilt::cli {
namespace {

using benchmark::PlanSample;
using benchmark::Tail;
using Json = nlohmann::ordered_json;

constexpr std::size_t kWorst = 5;

long preemptions() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nivcsw;
}

/// Observes every plan of a walk.
class Measurement {
 public:
  explicit Measurement(const control::Planner& planner) : planner_(planner) {}

  void before() {
    preemptions_ = preemptions();
    start_ = Clock::now();
  }

  void after(const control::PlannerInput& input, const sqp::SolveReport& report) {
    PlanSample sample;
    sample.solve_us = 1e6 * std::chrono::duration<double>(Clock::now() - start_).count();
    sample.preempted = preemptions() != preemptions_;
    sample.time_s = input.time_s;
    benchmark::describe_work(planner_, report, *table_, sample);
    samples.push_back(sample);
  }

  std::vector<PlanSample> samples;

 private:
  using Clock = std::chrono::steady_clock;

  const control::Planner& planner_;
  const std::unique_ptr<benchmark::WorkTable> table_ = std::make_unique<benchmark::WorkTable>();
  Clock::time_point start_;
  long preemptions_ = 0;
};

struct Summary {
  Tail solve_us, undisturbed_us, instructions;
  std::size_t preempted = 0;
};

Summary summarise(const std::vector<PlanSample>& samples) {
  std::vector<double> solve_us;
  std::vector<double> undisturbed_us;
  std::vector<double> instructions;
  for (const PlanSample& sample : samples) {
    solve_us.push_back(sample.solve_us);
    if (!sample.preempted) undisturbed_us.push_back(sample.solve_us);
    instructions.push_back(static_cast<double>(sample.instructions));
  }
  const std::size_t preempted = solve_us.size() - undisturbed_us.size();
  return {benchmark::tail(std::move(solve_us)), benchmark::tail(std::move(undisturbed_us)),
          benchmark::tail(std::move(instructions)), preempted};
}

Json to_json(const Tail& tail) {
  return {{"p50", tail.p50},
          {"p99", tail.p99},
          {"p999", tail.p999},
          {"max", tail.max},
          {"p999_over_p50", tail.ratio()}};
}

Json to_json(const PlanSample& sample) {
  return {{"time_s", sample.time_s},
          {"solve_us", sample.solve_us},
          {"preempted", sample.preempted},
          {"instructions", sample.instructions},
          {"iterations", sample.iterations},
          {"trial_steps", sample.trial_steps},
          {"stages", sample.stages},
          {"transitions", sample.transitions},
          {"double_support_stages", sample.double_support_stages}};
}

Json to_json(const Summary& summary, const std::vector<PlanSample>& samples) {
  Json json;
  json["plans"] = samples.size();
  json["isa"] = model::name_of(dispatch::instruction_set_of_build());
  json["solve_us"] = to_json(summary.solve_us);
  json["preempted_plans"] = summary.preempted;
  json["undisturbed_us"] = to_json(summary.undisturbed_us);
  json["instructions"] = benchmark::can_count_work() ? to_json(summary.instructions) : Json(nullptr);
  json["worst"] = Json::array();
  for (const PlanSample& sample : benchmark::worst(samples, kWorst)) {
    json["worst"].push_back(to_json(sample));
  }
  return json;
}

void print_tail(const char* name, const Tail& tail, double unit) {
  std::printf("%-14s p50 %9.3f, p99 %9.3f, p99.9 %9.3f, max %9.3f: p99.9 is %.3f of the median\n", name,
              tail.p50 * unit, tail.p99 * unit, tail.p999 * unit, tail.max * unit, tail.ratio());
}

void print(const Summary& summary, const std::vector<PlanSample>& samples) {
  std::printf("%zu plans in closed loop, %s; %zu were interrupted by the operating system\n", samples.size(),
              model::name_of(dispatch::instruction_set_of_build()).data(), summary.preempted);
  print_tail("time, ms", summary.solve_us, 1e-3);
  print_tail("uninterrupted", summary.undisturbed_us, 1e-3);
  if (benchmark::can_count_work()) print_tail("Minstructions", summary.instructions, 1e-6);
  std::printf("the plans with the most instructions:\n");
  for (const PlanSample& s : benchmark::worst(samples, kWorst)) {
    std::printf(
        "  %7.2f s  %9.3f M, %7.3f ms, %d iterations, %d trial steps, %d stages, of them %d touch-downs and "
        "%d of double support\n",
        s.time_s, 1e-6 * static_cast<double>(s.instructions), 1e-3 * s.solve_us, s.iterations, s.trial_steps,
        s.stages, s.transitions, s.double_support_stages);
  }
}

}  // namespace

int run_closed_loop_bench(const BenchOptions& options) {
  ControllerChoice choice = options.choice;
  choice.no_early_stop = true;
  const auto controller =
      make_controller(controller_setup(choice, robot_model(choice.robot), controller_configuration(choice)));
  std::vector<simulation::Push> pushes;
  for (const std::string& text : options.pushes) pushes.push_back(simulation::parse_push(text));
  simulation::check_pushes(pushes, 1e-9 * static_cast<double>(controller->timing().tick_ns));
  const control::Planner* planner = benchmark::planner_of_build(controller->planner());
  if (planner == nullptr) {
    throw UsageError(
        "--closed-loop: counts the instructions of the planner for the whole program's instruction set; "
        "leave sqp.instruction_set at auto");
  }
  Measurement measurement(*planner);
  const PlanObserver observer{
      [&] { measurement.before(); },
      [&](const control::PlannerInput& input) { measurement.after(input, controller->report()); }};
  const bool survived =
      walk(choice, {.speed_m_s = options.speed_m_s, .plans = options.closed_loop_plans, .pushes = pushes},
           *controller, observer);
  const Summary summary = summarise(measurement.samples);
  if (!options.json_file.empty()) write_json(to_json(summary, measurement.samples), options.json_file);
  if (options.json_file != "-") print(summary, measurement.samples);
  if (!survived) std::fputs("stilt bench: the robot fell\n", stderr);
  return survived ? 0 : 1;
}

}  // namespace stilt::cli
