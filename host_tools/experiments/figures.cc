#include "host_tools/experiments/figures.h"

#include <cmath>
#include <functional>

#include "host_tools/experiments/periodicity.h"
#include "host_tools/experiments/postures.h"
#include "host_tools/experiments/recovery_tiles.h"
#include "host_tools/experiments/steps.h"
#include "host_tools/experiments/table_text.h"

namespace stilt::experiments {
namespace {

using log::RunRecord;
using log::RunSample;
using plot::Curve;
using plot::Plot;
using Value = std::function<double(const RunSample&)>;

constexpr double kSettled_s = 4.0;
constexpr double kPushStart_s = 4.2;
constexpr double kPushDuration_s = 1.0;
constexpr double kPush_N = 20.0;
constexpr double kLargePush_N = 130.0;  // 80 % of what is survived at every phase (pushes.json), whole tens
constexpr const char* kRecoveries =
    "<h2>Recoveries: steps that do not repeat themselves</h2><p>Postures at the touch-downs, from the last "
    "one "
    "before the push to the one from which the walk is as fast as before it. Above: time from the start of "
    "the "
    "push; below: length of the step; red while the push acts.</p>";
constexpr const char* kJointNames[model::kJoints] = {"hip L", "knee L", "hip R", "knee R"};
constexpr const char* kColours[model::kJoints] = {"var(--a)", "var(--b)", "var(--c)", "var(--d)"};

struct Window {
  double from_s, to_s;
};

Curve curve(const RunRecord& record, Window window, const char* name, const char* colour,
            const Value& value) {
  Curve line{name, colour, {}, {}};
  for (const RunSample& sample : record.samples) {
    if (sample.time_s < window.from_s || sample.time_s > window.to_s) continue;
    line.x.push_back(sample.time_s);
    line.y.push_back(value(sample));
  }
  return line;
}

/// Plots one quantity of each joint over time.
std::string joints(const RunRecord& record, Window window, const std::string& title, const char* unit,
                   const std::function<double(const RunSample&, int joint)>& value) {
  Plot figure{title, "time (s)", unit, {}};
  for (int joint = 0; joint < model::kJoints; ++joint) {
    figure.curves.push_back(curve(record, window, kJointNames[joint], kColours[joint],
                                  [&](const RunSample& sample) { return value(sample, joint); }));
  }
  return plot::card(plot::svg(figure));
}

std::string single(const RunRecord& record, Window window, const std::string& title, const char* unit,
                   const Value& value) {
  Plot figure{title, "time (s)", unit, {curve(record, window, "", "var(--a)", value)}};
  return plot::card(plot::svg(figure));
}

double joint_angle(const RunSample& sample, int joint) {
  return sample.true_state[model::kFirstJoint + joint];
}

std::string push_plots(const RunRecord& record) {
  const Window window{kPushStart_s - 1.0, kPushStart_s + 3.0};
  std::string plots;
  plots += single(record, window, "Push at the hip", "N", [](const RunSample& s) { return s.push_N; });
  plots += single(record, window, "Forward speed of the hip", "m/s",
                  [](const RunSample& s) { return s.true_state[model::kPositions]; });
  plots +=
      single(record, window, "Height of the hip", "m", [](const RunSample& s) { return s.true_state[1]; });
  plots += single(record, window, "Pitch of the torso", "rad",
                  [](const RunSample& s) { return s.true_state[model::kFirstAngle]; });
  plots += joints(record, window, "Joint angles", "rad", joint_angle);
  plots += joints(record, window, "Joint rates", "rad/s", [](const RunSample& s, int joint) {
    return s.true_state[model::kPositions + model::kFirstJoint + joint];
  });
  plots += joints(record, window, "Joint torques", "Nm",
                  [](const RunSample& s, int joint) { return s.torque_Nm[joint]; });
  Plot forces{"Contact forces", "time (s)", "N", {}};
  constexpr const char* kForces[] = {"x L", "z L", "x R", "z R"};
  for (int i = 0; i < 2 * model::kFeet; ++i) {
    forces.curves.push_back(curve(record, window, kForces[i], kColours[i],
                                  [i](const RunSample& s) { return s.contact_force_N[i]; }));
  }
  return plots + plot::card(plot::svg(forces));
}

/// Draws the postures of two steps side by side.
std::string tiles(const RunRecord& record, const std::string& title) {
  constexpr int kTiles = 9;
  constexpr double kApart_m = 0.75;
  constexpr double kTwoSteps_s = 0.6;
  Plot figure{title, "x, tiles set apart (m)", "z (m)", {}, true, 1380.0, 290.0};
  int tile = 0;
  for (const RunSample& sample : record.samples) {
    if (tile == kTiles || sample.time_s < kSettled_s + tile * kTwoSteps_s / (kTiles - 1)) continue;
    const Posture posture = posture_of(record.robot, sample.true_state);
    draw(record.robot, posture, tile * kApart_m - posture.hip_x_m, figure);
    ++tile;
  }
  return plot::card(plot::svg(figure), true);
}

/// Draws the ends of the plans of two steps.
std::string plan_ends(const RunRecord& record, const std::string& title) {
  constexpr double kApart_m = 0.75;
  constexpr int kShown = 9;
  Plot figure{title, "x, tiles set apart (m)", "z (m)", {}, true, 1380.0, 290.0};
  int shown = 0;
  for (const log::PlanSnapshot& plan : record.plans) {
    if (plan.time_s < kSettled_s || shown == kShown) continue;
    const Posture posture = end_posture(record.robot, plan);
    draw(record.robot, posture, shown * kApart_m - posture.hip_x_m, figure);
    ++shown;
  }
  return plot::card(plot::svg(figure), true);
}

struct Recovery {
  std::string card;
  Json numbers;
};

Recovery recovery(const RunRecord& record, double force_N, double unpushed_m_s) {
  const double end_s = kPushStart_s + kPushDuration_s;
  const PushedWalk push{force_N, kPushStart_s, end_s,
                        recovery_steps(record.summary.steps, end_s, unpushed_m_s)};
  const std::string title = "Touch-downs around a push of " + text("%.0f N for 1 s", force_N);
  return {plot::card(plot::svg(recovery_tiles(record, push, title)), true), recovery_json(record, push)};
}

}  // namespace

FiguresResult make_figures(const WalkRunner& run, double duration_s) {
  struct Compared {
    const char* controller;
    double horizon_s;
    const char* title;
  };
  constexpr Compared kCompared[] = {{"mpc-heuristic", 1.0, "mpc-heuristic, horizon 1.0 s"},
                                    {"mpc-heuristic", 0.5, "mpc-heuristic, horizon 0.5 s"},
                                    {"mpc-hzd", 0.5, "mpc-hzd, horizon 0.5 s"}};
  WalkCase walk;
  walk.keep_samples = true;
  walk.duration_s = duration_s;
  walk.push_N = kPush_N;
  walk.push_start_s = kPushStart_s;
  walk.push_duration_s = kPushDuration_s;
  const RunRecord pushed = run(walk);
  walk.push_N = kLargePush_N;
  const RunRecord pushed_hard = run(walk);
  walk.push_N = 0.0;
  const double unpushed_m_s = run(walk).summary.mean_speed_m_s;
  const Recovery small = recovery(pushed, kPush_N, unpushed_m_s);
  const Recovery large = recovery(pushed_hard, kLargePush_N, unpushed_m_s);
  std::string body =
      "<h1>Walking at 0.5 m/s, as published</h1><p>Simulated robot with sensors only.</p>"
      "<h2>A push of 20 N for 1 s (mpc-heuristic, horizon 1.0 s)</h2>"
      "<div class='grid-of-plots'>" +
      push_plots(pushed) + "</div>" + kRecoveries + "<div class='grid-of-plots'>" + small.card + large.card +
      "</div>";
  FiguresResult figures;
  figures.numbers["push"] = {{"force_N", kPush_N},
                             {"survived", pushed.summary.survived},
                             {"peak_torque_Nm", pushed.summary.peak_torque_Nm.maxCoeff()},
                             {"saturated_s", pushed.summary.saturated_s},
                             {"step_length_min_m", pushed.summary.step_length_min_m},
                             {"step_length_max_m", pushed.summary.step_length_max_m}};
  figures.numbers["recovery"] = Json::array({small.numbers, large.numbers});
  figures.numbers["periodicity"] = Json::array();
  for (const Compared& compared : kCompared) {
    walk.controller = compared.controller;
    walk.horizon_s = compared.horizon_s;
    walk.sensor_noise_scale = 1.0;
    const Periodicity noisy = periodicity(run(walk), kSettled_s);
    walk.sensor_noise_scale = 0.0;
    const RunRecord record = run(walk);
    const Periodicity variation = periodicity(record, kSettled_s);
    figures.numbers["periodicity"].push_back({{"controller", compared.controller},
                                              {"horizon_s", compared.horizon_s},
                                              {"survived", record.summary.survived},
                                              {"steps", variation.steps},
                                              {"joint_angle_std_rms_rad", variation.rms_rad},
                                              {"joint_angle_std_max_rad", variation.largest_rad},
                                              {"noisy_joint_angle_std_rms_rad", noisy.rms_rad}});
    body += std::string("<h2>") + compared.title + "</h2><p>Joint angles vary from step to step by " +
            text("%.4f", variation.rms_rad) +
            " rad (standard deviation, root mean square over joints and the step; " + "largest " +
            text("%.4f", variation.largest_rad) + " rad; " + std::to_string(variation.steps) +
            " steps; with sensor noise " + text("%.4f", noisy.rms_rad) +
            " rad).</p><div class='grid-of-plots'>" + tiles(record, "Two steps, posture by posture") +
            joints(record, {kSettled_s, kSettled_s + 3.0}, "Joint angles", "rad", joint_angle) +
            plan_ends(record, "Where plans end: the state under the terminal cost, a plan every 0.05 s") +
            "</div>";
  }
  figures.page = plot::page("Stilt: the published figures", body);
  return figures;
}

}  // namespace stilt::experiments
