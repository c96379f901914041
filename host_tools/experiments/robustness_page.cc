#include "host_tools/experiments/robustness_page.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host_tools/experiments/robustness.h"
#include "host_tools/experiments/table_text.h"
#include "host_tools/web/plot/svg_plot.h"

namespace stilt::experiments {
namespace {

using plot::Curve;

constexpr std::size_t kPlots = 12;
constexpr const char* kPageStyle =
    "<style>h2{font-size:17px;margin:26px 0 6px}.figure{font-size:34px;color:var(--text);margin:8px 0 0}"
    "code{font-size:12px;overflow-wrap:anywhere;color:var(--text)}.card{margin-bottom:14px}"
    "summary{cursor:pointer}a{color:var(--a)}td.good,td.bad{white-space:nowrap}</style>";

std::string percent(const Json& number) { return text("%.1f", 100.0 * number.get<double>()) + " %"; }

std::string words_of(const Json& field) { return plot::escaped(field.get<std::string>()); }

/// The unit after `separator`; empty for a pure number.
std::string unit_of(const Json& quantity, const char* separator) {
  const auto unit = quantity.at("unit").get<std::string>();
  return unit == "1" ? "" : separator + unit;
}

/// Text of what happened in a run.
std::string outcome_text(const Json& result) {
  return result.at("survived").get<bool>() ? "margin " + cell(result.at("fall_margin_min"), "%.2f")
                                           : "falls at " + cell(result.at("fall_time_s"), "%.2f") + " s";
}

/// Distance of a drawn value from nominal, 1 at the farther end of the range; 0 without a nominal value.
double deviation(const Json& quantity, const Json& result) {
  if (quantity.at("nominal").is_null()) return 0.0;
  const double nominal = quantity.at("nominal").get<double>();
  const double farthest = std::max(std::abs(quantity.at("low").get<double>() - nominal),
                                   std::abs(quantity.at("high").get<double>() - nominal));
  return std::abs(value_of(quantity.at("name").get<std::string>(), result) - nominal) / farthest;
}

/// The three quantities of a run that are farthest from nominal.
std::string farthest_text(const Json& quantities, const Json& result) {
  constexpr std::size_t kShown = 3;
  std::vector<const Json*> order;
  for (const Json& quantity : quantities) order.push_back(&quantity);
  std::ranges::stable_sort(order, {}, [&](const Json* quantity) { return -deviation(*quantity, result); });
  std::string all;
  for (std::size_t i = 0; i < std::min(kShown, order.size()); ++i) {
    const double value = value_of(order[i]->at("name").get<std::string>(), result);
    all += (i > 0 ? "; " : "") + words_of(order[i]->at("words")) + " " + text("%.4g", value) +
           plot::escaped(unit_of(*order[i], " "));
  }
  return all;
}

std::string worst_table(const Json& merged) {
  std::string rows = "<table><tr><th>run</th><th>outcome</th><th></th><th>farthest from nominal</th></tr>";
  for (const Json& one : merged.at("worst")) {
    const bool survived = one.at("survived").get<bool>();
    rows += "<tr><td class='n'>" + cell(one.at("run"), "%.0f") + "</td><td class='" +
            (survived ? "good" : "bad") + "'>" + outcome_text(one) + "</td><td><a href='" +
            words_of(one.at("page")) + "'>replay</a></td><td>" + farthest_text(merged.at("quantities"), one) +
            "<details><summary>command</summary><code>" + words_of(one.at("command")) +
            "</code></details></td></tr>";
  }
  return rows + "</table>";
}

/// Bold where the interval leaves out 0.
std::string correlation_cell(const Json& estimate) {
  if (estimate.is_null()) return "<td></td>";
  const std::string words = estimate_text(estimate, "%+.2f");
  const bool is_clear = estimate.at("low").get<double>() > 0.0 || estimate.at("high").get<double>() < 0.0;
  return "<td class='n'>" + (is_clear ? "<b>" + words + "</b>" : words) + "</td>";
}

std::string correlation_table(const Json& quantities) {
  std::string rows =
      "<table><tr><th>quantity</th><th>from</th><th>to</th><th>nominal</th><th>value and falling</th>"
      "<th>value and margin</th><th>distance from nominal and margin</th></tr>";
  for (const Json& one : quantities) {
    rows += "<tr><td>" + words_of(one.at("words")) + plot::escaped(unit_of(one, ", ")) +
            "</td><td class='n'>" + cell(one.at("low"), "%g") + "</td><td class='n'>" +
            cell(one.at("high"), "%g") + "</td><td class='n'>" + cell(one.at("nominal"), "%g", "") + "</td>" +
            correlation_cell(one.at("falls")) + correlation_cell(one.at("margin")) +
            correlation_cell(one.at("distance")) + "</tr>";
  }
  return rows + "</table>";
}

/// The smallest margin, 0 for a fall, over one quantity.
std::string scatter(const Json& quantity, const std::vector<Json>& results) {
  const auto name = quantity.at("name").get<std::string>();
  Curve kept{"on its feet", "var(--a)", {}, {}};
  Curve fallen{"falls", "var(--bad)", {}, {}};
  kept.dots = fallen.dots = true;
  for (const Json& result : results) {
    const bool survived = result.at("survived").get<bool>();
    Curve& curve = survived ? kept : fallen;
    curve.x.push_back(value_of(name, result));
    curve.y.push_back(survived ? result.at("fall_margin_min").get<double>() : 0.0);
  }
  const auto words = quantity.at("words").get<std::string>();
  return plot::card(plot::svg({words, words + unit_of(quantity, ", "), "smallest margin", {kept, fallen}}));
}

std::string margins_plot(const std::vector<Json>& results) {
  std::vector<double> margins;
  for (const Json& result : results) {
    margins.push_back(result.at("survived").get<bool>() ? result.at("fall_margin_min").get<double>() : 0.0);
  }
  std::ranges::sort(margins);
  Curve curve{"", "var(--a)", {}, margins};
  for (std::size_t i = 0; i < margins.size(); ++i) {
    curve.x.push_back(100.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(margins.size()));
  }
  return plot::card(plot::svg(
      {"Smallest margin of each run, ascending", "runs, %", "margin", {curve}, false, 1380.0, 260.0}));
}

}  // namespace

std::string robustness_page(const Json& merged, const std::vector<Json>& results) {
  const Json& survival = merged.at("survival");
  const Json& quantities = merged.at("quantities");
  std::string body =
      std::string(kPageStyle) + "<h1>Random robots and worlds</h1><p>" + words_of(merged.at("controller")) +
      ", horizon " + cell(merged.at("horizon_s"), "%.1f") + " s, walking at " +
      cell(merged.at("speed_m_s"), "%g") + " m/s; a push of " + cell(merged.at("force_N"), "%g") +
      " N for 1 s at a random phase of the step. The model of the controller has none of the changes except "
      "the "
      "delay of its plans.</p><div class='card'><p class='figure'>" +
      percent(survival.at("value")) + "</p><p>stay on their feet: " + cell(merged.at("survived"), "%.0f") +
      " of " + cell(merged.at("runs"), "%.0f") + ". 95 % interval " + percent(survival.at("low")) + " to " +
      percent(survival.at("high")) + " (Wilson).</p></div>";
  body +=
      "<h2>The worst runs</h2><p>Falls first, then the smallest margins. Margin: share of the way to a fall "
      "that "
      "is left, by the height of the hip or the pitch of the torso; 1 is upright, 0 has fallen. Commands "
      "of all runs: <a href='commands.txt'>commands.txt</a>.</p><div class='card'>" +
      worst_table(merged) + "</div>" + margins_plot(results);
  body +=
      "<h2>What goes with falls and small margins</h2><p>Correlation with 95 % interval. With falling: "
      "point-biserial, Fisher's interval. With the margin: Spearman's of the ranks, a fall below every "
      "margin, interval of Bonett and Wright. Bold where the interval leaves out 0: without any effect, one "
      "interval in 20 would by chance.</p><div class='card'>" +
      correlation_table(quantities) + "</div><h2>The strongest</h2><div class='grid-of-plots'>";
  for (std::size_t i = 0; i < std::min(kPlots, quantities.size()); ++i)
    body += scatter(quantities[i], results);
  return plot::page("Stilt: random robots and worlds", body + "</div>");
}

std::string commands_text(const std::vector<Json>& results) {
  std::string lines;
  for (const Json& one : results) {
    lines += one.at("command").get<std::string>() + "  # run " + cell(one.at("run"), "%.0f") + ", " +
             outcome_text(one) + "\n";
  }
  return lines;
}

}  // namespace stilt::experiments
