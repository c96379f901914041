#include "host_tools/web/report/report.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "host_tools/web/report/comparison_page.h"
#include "host_tools/web/report/packed_columns.h"
#include "host_tools/web/report/run_data.h"
#include "tests/host_tools/web/report/synthetic_walk.h"

namespace stilt::report {
namespace {

using nlohmann::json;
using Columns = std::map<std::string, std::vector<std::vector<float>>>;

std::vector<unsigned char> decode_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  std::uint32_t buffer = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    buffer = buffer << 6 | static_cast<std::uint32_t>(digits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<unsigned char>(buffer >> bits & 255u));
  }
  return bytes;
}

Columns unpack(const json& packed) {
  const auto bytes = decode_base64(packed["float32_base64"]);
  const auto rows = packed["rows"].get<std::size_t>();
  Columns columns;
  std::size_t next = 0;
  for (const json& group : packed["groups"]) {
    for (int k = 0; k < group["width"].get<int>(); ++k) {
      auto& column = columns[group["name"]].emplace_back();
      for (std::size_t row = 0; row < rows; ++row, next += 4) {
        std::uint32_t word = 0;
        for (std::size_t b = 0; b < 4; ++b) word |= std::uint32_t{bytes.at(next + b)} << (8 * b);
        column.push_back(std::bit_cast<float>(word));
      }
    }
  }
  EXPECT_EQ(next, bytes.size());
  return columns;
}

std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const auto start = text.find(from);
  if (start == std::string::npos) return {};
  const auto begin = start + from.size();
  return text.substr(begin, text.find(to, begin) - begin);
}

/// The data of a page, found as a browser finds it: up to the first end of the script element.
json embedded_data(const std::string& page) {
  return json::parse(between(page, R"(<script type="application/json" id="run-data">)", "</script>"));
}

TEST(Report, TheEmbeddedSamplesAreTheRecordInSinglePrecision) {
  const log::RunRecord record = synthetic_walk(8.0);
  const Columns columns = unpack(embedded_data(render_report(record))["ticks"]);
  ASSERT_EQ(columns.at("time_s")[0].size(), record.samples.size());
  for (std::size_t i = 0; i < record.samples.size(); ++i) {
    const log::RunSample& sample = record.samples[i];
    const auto expect_group = [&](const char* name, const auto& values) {
      ASSERT_EQ(columns.at(name).size(), static_cast<std::size_t>(values.size()));
      for (int k = 0; k < values.size(); ++k) {
        ASSERT_EQ(columns.at(name)[static_cast<std::size_t>(k)][i], static_cast<float>(values[k]))
            << name << i;
      }
    };
    const auto expect = [&](const char* name, double value) {
      ASSERT_EQ(columns.at(name)[0][i], static_cast<float>(value)) << name << i;
    };
    expect("time_s", sample.time_s);
    expect_group("true_state", sample.true_state);
    expect_group("estimated_state", sample.estimated_state);
    expect_group("planned_state", sample.planned_state);
    expect_group("torque_Nm", sample.torque_Nm);
    expect_group("contact_force_N", sample.contact_force_N);
    expect_group("planned_contact_force_N", sample.planned_contact_force_N);
    expect_group("foot_position_m", sample.foot_position_m);
    expect_group("scheduled_mode", Eigen::Vector2d(sample.scheduled_mode.left, sample.scheduled_mode.right));
    expect("push_N", sample.push_N);
    expect("push_above_hip_m", sample.push_above_hip_m);
    expect("commanded_speed_m_s", sample.commanded_speed_m_s);
  }
}

TEST(Report, TheEmbeddedSolvesAreTheRecord) {
  log::RunRecord record = synthetic_walk(1.0);
  record.solves[7].report.status = sqp::SolveStatus::not_convex;
  const json data = embedded_data(render_report(record))["planner"];
  const Columns columns = unpack(data);
  ASSERT_EQ(columns.at("time_s")[0].size(), record.solves.size());
  for (std::size_t i = 0; i < record.solves.size(); ++i) {
    const log::SolveSample& solve = record.solves[i];
    EXPECT_EQ(columns.at("solve_ms")[0][i], static_cast<float>(1e-3 * solve.solve_us));
    EXPECT_EQ(columns.at("iterations")[0][i], static_cast<float>(solve.report.iterations));
    EXPECT_EQ(columns.at("dynamics_defect_max")[0][i], static_cast<float>(solve.report.dynamics_defect_max));
    EXPECT_EQ(columns.at("equality_violation_max")[0][i],
              static_cast<float>(solve.report.equality_violation_max));
  }
  EXPECT_EQ(data["status_names"][static_cast<std::size_t>(columns.at("status")[0][7])], "not convex");
  EXPECT_EQ(data["status_names"][static_cast<std::size_t>(columns.at("status")[0][8])], "converged");
}

TEST(Report, EachDrawnPlanCoversItsWholeHorizonWithNodesOfTheRecord) {
  const log::RunRecord record = synthetic_walk(8.0);
  const json data = embedded_data(render_report(record))["plans"];
  const Columns nodes = unpack(data["nodes"]);
  const auto stride = data["stride"].get<std::size_t>();
  ASSERT_EQ(data["time_s"].size(), (record.plans.size() + stride - 1) / stride);
  for (std::size_t i = 0; i < data["time_s"].size(); ++i) {
    const log::PlanSnapshot& plan = record.plans[i * stride];
    const bool last = i + 1 == data["time_s"].size();
    const auto from = data["first_node"][i].get<std::size_t>();
    const auto to = last ? nodes.at("time_s")[0].size() : data["first_node"][i + 1].get<std::size_t>();
    ASSERT_LT(from, to);
    EXPECT_EQ(data["time_s"][i].get<double>(), plan.time_s);
    EXPECT_EQ(nodes.at("time_s")[0][from], static_cast<float>(plan.node_time_s.front()));
    EXPECT_EQ(nodes.at("time_s")[0][to - 1], static_cast<float>(plan.node_time_s.back()));
    EXPECT_EQ(nodes.at("base_x_m")[0][to - 1], static_cast<float>(plan.base_x_m.back()));
    EXPECT_EQ(nodes.at("base_z_m")[0][to - 1], static_cast<float>(plan.base_z_m.back()));
    EXPECT_EQ(nodes.at("pitch_rad")[0][to - 1], static_cast<float>(plan.pitch_rad.back()));
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(nodes.at("foot_position_m")[k][from], static_cast<float>(plan.foot_position_m.front()[k]));
    }
  }
}

TEST(Report, TheEmbeddedSummaryIsTheRecord) {
  log::RunRecord record = synthetic_walk(8.0);
  record.summary.heap_allocations_in_loop = 3;
  const json data = embedded_data(render_report(record));
  const json& s = data["summary"];
  EXPECT_EQ(data["command_line"], record.command_line);
  EXPECT_EQ(data["robot"]["thigh_length_m"], record.robot.thigh_length_m);
  EXPECT_EQ(data["torque_limit_Nm"], json::array({80.0, 80.0, 80.0, 80.0}));
  EXPECT_EQ(s["survived"], true);
  EXPECT_TRUE(s["fall_time_s"].is_null());
  EXPECT_EQ(s["duration_s"], 8.0);
  EXPECT_EQ(s["distance_m"], record.summary.distance_m);
  EXPECT_EQ(s["mean_speed_m_s"], record.summary.mean_speed_m_s);
  ASSERT_EQ(s["steps"].size(), record.summary.steps.size());
  EXPECT_EQ(s["steps"][2]["foot"], record.summary.steps[2].foot);
  EXPECT_EQ(s["steps"][2]["time_s"], record.summary.steps[2].time_s);
  EXPECT_EQ(s["steps"][2]["length_m"], record.summary.steps[2].length_m);
  EXPECT_EQ(s["steps_known"], true);
  EXPECT_EQ(s["step_length_min_m"], record.summary.step_length_min_m);
  EXPECT_EQ(s["step_length_max_m"], record.summary.step_length_max_m);
  EXPECT_EQ(s["peak_torque_Nm"], json::array({12.0, 33.0, 12.0, 33.0}));
  EXPECT_EQ(s["peak_joint_speed_rad_s"], json::array({1.5, 2.4, 1.5, 2.4}));
  EXPECT_EQ(s["slip_distance_m"], record.summary.slip_distance_m);
  EXPECT_EQ(s["solve_time_us"], json({{"p50", 1400.0}, {"p99", 1880.0}, {"max", 1900.0}}));
  EXPECT_EQ(s["sqp_iterations"], json({{"mean", 2.2}, {"max", 3}}));
  EXPECT_EQ(s["dynamics_defect_max"], record.summary.dynamics_defect_max);
  EXPECT_EQ(s["equality_violation_max"], record.summary.equality_violation_max);
  EXPECT_EQ(s["heap_allocations_in_loop"], 3);
  EXPECT_EQ(s["controller_bytes"], record.summary.controller_bytes);
}

TEST(Report, AFallKeepsItsTime) {
  log::RunRecord record = synthetic_walk(1.0);
  record.summary.survived = false;
  record.summary.fall_time_s = 0.75;
  const json summary = embedded_data(render_report(record))["summary"];
  EXPECT_EQ(summary["survived"], false);
  EXPECT_EQ(summary["fall_time_s"], 0.75);
}

TEST(Report, ThePageLoadsNothing) {
  const std::string page = render_report(synthetic_walk(1.0));
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  for (std::size_t at = page.find("url("); at != std::string::npos; at = page.find("url(", at + 1)) {
    EXPECT_EQ(page[at + 4], '#') << "not within the page: " << page.substr(at, 40);
  }
  for (const char* source : {" src=", "@import", "href=\"h", "href=\"/", "import(", "fetch("}) {
    EXPECT_EQ(page.find(source), std::string::npos) << source;
  }
}

TEST(Report, ThePageHasItsPlotLibraryWithLicenceAndNoMarkLeft) {
  const std::string page = render_report(synthetic_walk(1.0));
  EXPECT_NE(page.find("uPlot"), std::string::npos);
  EXPECT_NE(page.find("Permission is hereby granted, free of charge"), std::string::npos);
  for (const char* mark : {"{{title}}", "{{run_data}}", "{{style}}", "{{script}}", "{{uplot_"}) {
    EXPECT_EQ(page.find(mark), std::string::npos) << mark;
  }
  EXPECT_TRUE(page.ends_with("</html>\n"));
}

TEST(Report, TextFromOutsideCannotBecomeMarkup) {
  const std::string attack = "</script><!--<script>alert(1)</script>{{run_data}}&\"'\xff\xe2\x80\xa8";
  log::RunRecord record = synthetic_walk(1.0);
  const std::string harmless = render_report(record);
  record.command_line = attack;
  record.robot.name = attack;
  record.summary.steps[0].foot = attack;
  const std::string page = render_report(record);
  EXPECT_EQ(page.find("alert(1)</script>"), std::string::npos);
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_EQ(page.find("<!--", 1), harmless.find("<!--", 1));
  const std::string shown = embedded_data(page)["command_line"];
  EXPECT_TRUE(shown.starts_with("</script><!--<script>alert(1)</script>{{run_data}}&\"'")) << shown;
}

TEST(Report, WhatIsNotKnownOfARunIsNoNumber) {
  log::RunRecord run = synthetic_walk(1.0);
  run.summary.steps_known = false;
  run.summary.slip_distance_m = run.summary.distance_m = std::numeric_limits<double>::quiet_NaN();
  run.summary.peak_torque_Nm[2] = std::numeric_limits<double>::quiet_NaN();
  const json s = json::parse(run_data_json(run))["summary"];
  EXPECT_EQ(s["steps_known"], false);
  EXPECT_FALSE(s["steps"].empty()) << "those that are known";
  EXPECT_TRUE(s["slip_distance_m"].is_null());
  EXPECT_TRUE(s["distance_m"].is_null());
  EXPECT_TRUE(s["peak_torque_Nm"][2].is_null());
}

TEST(Report, MissingTicksAreInThePage) {
  log::RunRecord run = synthetic_walk(1.0);
  EXPECT_TRUE(json::parse(run_data_json(run))["missing_ticks"].empty());
  run.missing_ticks.push_back({200, 299, 0.2, 0.299});
  const json data = json::parse(run_data_json(run));
  EXPECT_EQ(data["missing_ticks"],
            json::array({{{"first", 200}, {"last", 299}, {"from_s", 0.2}, {"to_s", 0.299}}}));
}

TEST(Report, NonFiniteNumbersStayReadable) {
  log::RunRecord record = synthetic_walk(1.0);
  record.samples[5].torque_Nm[1] = std::numeric_limits<double>::quiet_NaN();
  record.samples[6].torque_Nm[1] = -1e300;
  record.summary.mean_speed_m_s = std::numeric_limits<double>::infinity();
  const json data = embedded_data(render_report(record));
  const auto torque = unpack(data["ticks"]).at("torque_Nm")[1];
  EXPECT_TRUE(std::isnan(torque[5]));
  EXPECT_EQ(torque[6], -std::numeric_limits<float>::infinity());
  EXPECT_TRUE(data["summary"]["mean_speed_m_s"].is_null());
}

TEST(Report, AnEmptyRunIsStillAPage) {
  const json data = embedded_data(render_report(log::RunRecord{}));
  EXPECT_EQ(data["ticks"]["rows"], 0);
  EXPECT_EQ(data["planner"]["rows"], 0);
  EXPECT_EQ(data["plans"]["nodes"]["rows"], 0);
}

TEST(Report, AMinuteAtTwoHundredSamplesASecondStaysUnderEightMegabytes) {
  const std::string page = render_report(synthetic_walk(60.0));
  EXPECT_LT(page.size(), 8'000'000u);
  EXPECT_EQ(embedded_data(page)["ticks"]["stride"], 1);
}

TEST(Report, AnHourIsThinnedEvenlyAndThePageHasTheShare) {
  log::RunRecord record;
  record.samples.resize(720'001);
  for (std::size_t i = 0; i < record.samples.size(); ++i) {
    log::RunSample& sample = record.samples[i];
    sample.time_s = static_cast<double>(i);
    for (auto* state : {&sample.true_state, &sample.estimated_state, &sample.planned_state}) state->setZero();
    for (auto* feet : {&sample.contact_force_N, &sample.planned_contact_force_N, &sample.foot_position_m}) {
      feet->setZero();
    }
    sample.torque_Nm.setZero();
  }
  const json samples = json::parse(run_data_json(record))["ticks"];
  const auto stride = samples["stride"].get<std::size_t>();
  EXPECT_GT(stride, 1u);
  EXPECT_LE(samples["rows"].get<std::size_t>(), kMaxSamples);
  const std::vector<float> time = unpack(samples).at("time_s")[0];
  for (std::size_t row = 0; row < time.size(); ++row) ASSERT_EQ(time[row], static_cast<float>(row * stride));
}

TEST(Report, TwoRunsAreInOnePageWithTheirDataUnchanged) {
  const log::RunRecord first = synthetic_walk(1.0);
  log::RunRecord second = synthetic_walk(2.0);
  second.command_line = "</script>second";
  second.controller = log::ControllerPart{"fault", {{0.5, "a driver failed"}}};
  second.settings = {{"gait.swing_height_m", "0.08"}};
  const std::string page = render_comparison(
      {{{"a.html", data_of_page(render_report(first))}, {"b </script>.mcap", run_data_json(second)}}}, 0.25);
  const json data = embedded_data(page);
  EXPECT_EQ(data["names"], json::array({"a.html", "b </script>.mcap"}));
  EXPECT_EQ(data["shift_s"], 0.25);
  EXPECT_EQ(data["runs"][0], json::parse(run_data_json(first)));
  EXPECT_EQ(data["runs"][1], json::parse(run_data_json(second)));
  EXPECT_TRUE(data["runs"][0]["controller"].is_null());
  EXPECT_EQ(data["runs"][1]["controller"]["last_state"], "fault");
  EXPECT_EQ(data["runs"][1]["controller"]["events"][0]["text"], "a driver failed");
  EXPECT_EQ(data["runs"][1]["settings"]["gait.swing_height_m"], "0.08");
}

TEST(Report, AnOutcomeThatIsNotKnownIsNull) {
  log::RunRecord run = synthetic_walk(1.0);
  EXPECT_TRUE(json::parse(run_data_json(run))["summary"]["survived"].is_boolean());
  run.outcome_known = false;
  EXPECT_TRUE(json::parse(run_data_json(run))["summary"]["survived"].is_null());
}

TEST(Report, APageThatIsNoReportHasNoData) {
  EXPECT_EQ(data_of_page("<html></html>"), "");
  EXPECT_EQ(data_of_page(R"(<script type="application/json" id="run-data">{)"), "") << "cut off";
}

TEST(PackedColumns, Base64FollowsTheTestVectorsOfRfc4648) {
  const std::map<std::string, std::string> vectors = {{"", ""},
                                                      {"f", "Zg=="},
                                                      {"fo", "Zm8="},
                                                      {"foo", "Zm9v"},
                                                      {"foob", "Zm9vYg=="},
                                                      {"fooba", "Zm9vYmE="},
                                                      {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, encoded] : vectors) {
    EXPECT_EQ(encode_base64(std::vector<unsigned char>(plain.begin(), plain.end())), encoded);
  }
}

}  // namespace
}  // namespace stilt::report
