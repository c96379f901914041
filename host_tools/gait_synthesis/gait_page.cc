#include "host_tools/gait_synthesis/gait_page.h"

#include <cmath>
#include <cstdio>

#include "host_tools/web/plot/svg_plot.h"

namespace stilt::gait_synthesis {
namespace {

using model::kFirstJoint;
using model::kJoints;
using plot::card;
using plot::Curve;
using plot::escaped;
using plot::Plot;

constexpr int kSamples = 200;
constexpr const char* kJointNames[kJoints] = {"stance hip", "stance knee", "swing hip", "swing knee"};
constexpr const char* kColours[kJoints] = {"var(--a)", "var(--b)", "var(--c)", "var(--d)"};

std::string number(double value) {
  char text[40];
  (void)std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

double fraction(int i) { return static_cast<double>(i) / kSamples; }

/// A curve over the time of one step.
template <class Value>
Curve over_step(const gait::HzdGait& gait, const std::string& name, const char* colour, const Value& value) {
  Curve curve{name, colour, {}, {}};
  for (int i = 0; i <= kSamples; ++i) {
    curve.x.push_back(fraction(i) * gait.step_time_s);
    curve.y.push_back(value(gait::motion_at(gait, fraction(i))));
  }
  return curve;
}

struct Point {
  double x, z;
};

/// Points from the hip at (x, z) along a chain of angles: hip, knee, foot.
std::vector<Point> leg(const model::RobotConstants& robot, const gait::GaitPoint& point, int first_joint) {
  const double thigh = point.position[2] + point.position[first_joint];
  const double shin = thigh + point.position[first_joint + 1];
  const Point hip{point.position[0], point.position[1]};
  const Point knee{hip.x - robot.thigh_length_m * std::sin(thigh),
                   hip.z - robot.thigh_length_m * std::cos(thigh)};
  return {hip,
          knee,
          {knee.x - robot.shin_length_m * std::sin(shin), knee.z - robot.shin_length_m * std::cos(shin)}};
}

Curve line(const std::vector<Point>& points, double shift_m, const char* colour) {
  Curve curve{"", colour, {}, {}};
  for (const Point& point : points) {
    curve.x.push_back(point.x + shift_m);
    curve.y.push_back(point.z);
  }
  return curve;
}

std::string tiles(const model::RobotConstants& robot, const gait::HzdGait& gait) {
  constexpr int kTiles = 9;
  constexpr double kSpacing_m = 0.75;
  Plot figure{"One step, posture by posture", "x, tiles set apart (m)", "z (m)", {}, true, 1380.0, 290.0};
  figure.curves.push_back(line({{-0.5, 0.0}, {(kTiles - 1) * kSpacing_m + 0.5, 0.0}}, 0.0, "var(--line)"));
  for (int i = 0; i < kTiles; ++i) {
    const gait::GaitPoint point = gait::motion_at(gait, static_cast<double>(i) / (kTiles - 1));
    const double shift_m = i * kSpacing_m;
    const double torso_m = 2.0 * robot.torso_com_height_m;
    const Point hip{point.position[0], point.position[1]};
    const double pitch = point.position[2];
    figure.curves.push_back(line(leg(robot, point, kFirstJoint + 2), shift_m, "var(--c)"));
    figure.curves.push_back(line(leg(robot, point, kFirstJoint), shift_m, "var(--a)"));
    figure.curves.push_back(
        line({hip, {hip.x + torso_m * std::sin(pitch), hip.z + torso_m * std::cos(pitch)}}, shift_m,
             "var(--text)"));
  }
  return card(plot::svg(figure), true);
}

/// Plots angle against rate over two steps: the joint's leg in stance, then in swing, with the jumps of the
/// rate in between.
std::string portrait(const gait::HzdGait& gait, int joint, const char* name) {
  Plot figure{std::string("Phase portrait of the ") + name, "angle (rad)", "rate (rad/s)", {}};
  const int in_stance = kFirstJoint + joint;
  const int in_swing = in_stance + 2;
  for (const int at : {in_stance, in_swing}) {
    const bool stance = at == in_stance;
    Curve curve{stance ? "stance" : "swing", stance ? "var(--a)" : "var(--c)", {}, {}};
    for (int i = 0; i <= kSamples; ++i) {
      const gait::GaitPoint point = gait::motion_at(gait, fraction(i));
      curve.x.push_back(point.position[at]);
      curve.y.push_back(point.velocity[at]);
    }
    figure.curves.push_back(curve);
  }
  for (int i = 0; i < 2; ++i) {
    const Curve& from = figure.curves[static_cast<std::size_t>(i)];
    const Curve& to = figure.curves[static_cast<std::size_t>(1 - i)];
    figure.curves.push_back({i == 0 ? "impact" : "",
                             "var(--muted)",
                             {from.x.back(), to.x.front()},
                             {from.y.back(), to.y.front()},
                             true});
  }
  return card(plot::svg(figure));
}

std::string base_portrait(const gait::HzdGait& gait) {
  Plot figure{"Phase portrait of the hip", "x ahead of the stance foot (m)", "forward speed (m/s)", {}};
  Curve curve{"", "var(--a)", {}, {}};
  for (int i = 0; i <= kSamples; ++i) {
    const gait::GaitPoint point = gait::motion_at(gait, fraction(i));
    curve.x.push_back(point.position[0]);
    curve.y.push_back(point.velocity[0]);
  }
  figure.curves.push_back(curve);
  return card(plot::svg(figure));
}

template <class Value>
std::string joint_curves(const gait::HzdGait& gait, const char* title, const char* unit, const Value& value) {
  Plot figure{title, "time since touch-down (s)", unit, {}};
  for (int j = 0; j < kJoints; ++j) {
    figure.curves.push_back(over_step(gait, kJointNames[j], kColours[j],
                                      [&](const gait::GaitPoint& point) { return value(point, j); }));
  }
  return card(plot::svg(figure));
}

std::string base_curves(const model::RobotModel& robot, const gait::HzdGait& gait) {
  const char* time = "time since touch-down (s)";
  Plot force{"Force on the stance foot", time, "N", {}};
  force.curves.push_back(
      over_step(gait, "x", "var(--a)", [](const auto& point) { return point.force_N[0]; }));
  force.curves.push_back(
      over_step(gait, "z", "var(--b)", [](const auto& point) { return point.force_N[1]; }));
  Plot swing{"Path of the swing foot", "x from the stance foot (m)", "z (m)", {}};
  Curve path{"", "var(--c)", {}, {}};
  for (int i = 0; i <= kSamples; ++i) {
    const Point foot = leg(robot.constants, gait::motion_at(gait, fraction(i)), kFirstJoint + 2).back();
    path.x.push_back(foot.x);
    path.y.push_back(foot.z);
  }
  swing.curves.push_back(path);
  Plot base{"Height of the hip", time, "m", {}};
  base.curves.push_back(over_step(gait, "", "var(--a)", [](const auto& point) { return point.position[1]; }));
  Plot pitch{"Pitch of the torso", time, "rad", {}};
  pitch.curves.push_back(
      over_step(gait, "", "var(--a)", [](const auto& point) { return point.position[2]; }));
  return card(plot::svg(force)) + card(plot::svg(swing)) + card(plot::svg(base)) + card(plot::svg(pitch));
}

std::string metrics_table(const gait_files::GaitRecord& record, const GaitCheck& check) {
  std::string rows = "<table><tr><th>metric</th><th>value</th><th></th></tr>";
  gait_files::GaitMetrics metrics = check.metrics;
  for (const auto& field : gait_files::metric_fields()) {
    std::string values;
    for (const double value : field.values(metrics)) values += (values.empty() ? "" : ", ") + number(value);
    rows += std::string("<tr><td>") + field.key + "</td><td class='n'>" + values + "</td><td>" +
            escaped(field.meaning) + "</td></tr>";
  }
  rows += "</table><br><table><tr><th>limit</th><th>value</th><th></th></tr>";
  gait_files::GaitLimits limits = record.limits;
  for (const auto& field : gait_files::limit_fields()) {
    rows += std::string("<tr><td>") + field.key + "</td><td class='n'>" + number(field.values(limits)[0]) +
            "</td><td>" + escaped(field.meaning) + "</td></tr>";
  }
  rows += "</table><br><table><tr><th>how it was made</th><th></th></tr>";
  for (const auto& [key, words] : record.origin) {
    rows += "<tr><td>" + escaped(key) + "</td><td>" + escaped(words) + "</td></tr>";
  }
  return card(rows + "</table>", true);
}

std::string heading(const gait_files::GaitRecord& record, const GaitCheck& check) {
  const gait::HzdGait& gait = record.gait;
  std::string verdict = "<span class='good'>valid</span>";
  if (!check.valid()) {
    std::string names;
    for (const Violation& violation : check.violations) {
      names += (names.empty() ? "" : "; ") + violation.text();
    }
    verdict = "<span class='bad'>not valid: " + escaped(names) + "</span>";
  }
  return "<h1>Gait of " + escaped(record.robot) + " at " + number(gait.speed_m_s) + " m/s</h1><p>" + verdict +
         " &middot; step of " + number(gait.step_length_m) + " m in " + number(gait.step_time_s) +
         " s &middot; outputs of degree " + std::to_string(gait.outputs.degree) + " along the " +
         (gait.outputs.phase == gait::PhaseKind::time ? "time" : "hip position") +
         " &middot; largest eigenvalue of the return map " + number(check.metrics.return_map_eigenvalues[0]) +
         "</p>\n";
}

}  // namespace

std::string render_gait_page(const model::RobotModel& robot, const gait_files::GaitRecord& record,
                             const GaitCheck& check) {
  const gait::HzdGait& gait = record.gait;
  std::string page;
  page += heading(record, check) + "<div class='grid-of-plots'>\n";
  page += tiles(robot.constants, gait);
  page += portrait(gait, 0, "hips") + portrait(gait, 1, "knees") + base_portrait(gait);
  page += joint_curves(gait, "Joint angles", "rad",
                       [](const gait::GaitPoint& point, int j) { return point.position[kFirstJoint + j]; });
  page += joint_curves(gait, "Joint rates", "rad/s",
                       [](const gait::GaitPoint& point, int j) { return point.velocity[kFirstJoint + j]; });
  page += joint_curves(gait, "Joint torques", "Nm",
                       [](const gait::GaitPoint& point, int j) { return point.torque_Nm[j]; });
  page += base_curves(robot, gait) + metrics_table(record, check);
  return plot::page("Stilt: gait of " + record.robot, page + "</div>");
}

}  // namespace stilt::gait_synthesis
