#include "host_tools/web/plot/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace stilt::plot {
namespace {

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--text:#1c2733;--muted:#5c6b7a;--line:#dde3ea;--card:#fff;--page:#f4f6f8;
--a:#1f6feb;--b:#0a8a5f;--c:#c2410c;--d:#9333a8;--bad:#b42318;--good:#0a8a5f}
@media(prefers-color-scheme:dark){:root{--text:#e6edf3;--muted:#9aa7b4;--line:#2c3640;--card:#161c23;--page:#0d1116;
--a:#6cb0ff;--b:#4ccb95;--c:#ff9a5c;--d:#d49bea;--bad:#ff8a80;--good:#4ccb95}}
body{margin:0 auto;max-width:1440px;padding:20px;background:var(--page);color:var(--text);font:15px/1.45 system-ui,sans-serif}
h1{font-size:22px;margin:0 0 4px}p{color:var(--muted);margin:0 0 16px}
.grid-of-plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(420px,1fr));gap:14px}
.card{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:10px;overflow-x:auto}
.wide{grid-column:1/-1}svg{width:100%;height:auto;display:block}
svg text{fill:var(--muted);font-size:11px}svg .title{fill:var(--text);font-size:14px;font-weight:600}
svg .grid{stroke:var(--line);fill:none}svg .curve{fill:none;stroke-width:1.8;stroke-linejoin:round}
svg .dots{fill:none;stroke-width:4.5;stroke-linecap:round;opacity:.65}
table{border-collapse:collapse;width:100%}td,th{text-align:left;padding:3px 10px 3px 0;border-bottom:1px solid var(--line)}
td.n{font-variant-numeric:tabular-nums}.bad{color:var(--bad);font-weight:600}.good{color:var(--good);font-weight:600}
)";

std::string number(double value) {
  char text[40];
  (void)std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// Range of an axis and its mapping to pixels.
struct Axis {
  double low, high;
  double from_px, to_px;
  [[nodiscard]] double px(double value) const {
    return from_px + (value - low) / (high - low) * (to_px - from_px);
  }
};

Axis axis_of(const Plot& plot, bool vertical, double from_px, double to_px) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  const auto hold = [&](double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  };
  for (const Curve& curve : plot.curves) std::ranges::for_each(vertical ? curve.y : curve.x, hold);
  for (const Label& label : plot.labels) hold(vertical ? label.y : label.x);
  if (!(low <= high)) low = 0.0, high = 1.0;
  const double room = high > low ? 0.04 * (high - low) : 0.5;
  return {low - room, high + room, from_px, to_px};
}

/// Widens the axis with the larger scale about its middle.
void make_scales_equal(Axis& x, Axis& y) {
  const double x_scale = std::abs(x.to_px - x.from_px) / (x.high - x.low);
  const double y_scale = std::abs(y.to_px - y.from_px) / (y.high - y.low);
  Axis& wide = x_scale > y_scale ? x : y;
  const double factor = std::max(x_scale, y_scale) / std::min(x_scale, y_scale);
  const double middle = 0.5 * (wide.low + wide.high);
  const double half = 0.5 * factor * (wide.high - wide.low);
  wide.low = middle - half;
  wide.high = middle + half;
}

std::vector<double> ticks(const Axis& axis) {
  const double rough = (axis.high - axis.low) / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double step = power * (rough / power < 1.5   ? 1.0
                               : rough / power < 3.5 ? 2.0
                               : rough / power < 7.5 ? 5.0
                                                     : 10.0);
  std::vector<double> values;
  for (double v = std::ceil(axis.low / step) * step; v <= axis.high; v += step) {
    values.push_back(std::abs(v) < 1e-9 * step ? 0.0 : v);
  }
  return values;
}

std::string text(double x, double y, const char* anchor, const std::string& words, const char* more = "") {
  return "<text x='" + number(x) + "' y='" + number(y) + "' text-anchor='" + anchor + "' " + more + ">" +
         escaped(words) + "</text>";
}

std::string fill(const std::string& colour) { return "style='fill:" + colour + "'"; }

std::string path(const Curve& curve, const Axis& x, const Axis& y) {
  std::string d;
  bool pen_down = false;
  for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
    const bool finite = std::isfinite(curve.x[i]) && std::isfinite(curve.y[i]);
    if (finite) {
      d += pen_down && !curve.dots ? 'L' : 'M';
      d += number(x.px(curve.x[i]));
      d += ' ';
      d += number(y.px(curve.y[i]));
      if (curve.dots) d += "h0";
    }
    pen_down = finite;
  }
  return std::string("<path class='") + (curve.dots ? "dots" : "curve") + "' d='" + d +
         "' style='stroke:" + curve.colour + "'" + (curve.dashed ? " stroke-dasharray='5 4'" : "") + "/>";
}

std::string grid(const Plot& plot, const Axis& x, const Axis& y) {
  std::string result;
  for (const double v : ticks(x)) {
    const std::string at = number(x.px(v));
    result += "<path class='grid' d='M" + at + " " + number(y.from_px) + "V" + number(y.to_px) + "'/>" +
              text(x.px(v), y.from_px + 15.0, "middle", number(v));
  }
  for (const double v : ticks(y)) {
    const std::string at = number(y.px(v));
    result += "<path class='grid' d='M" + number(x.from_px) + " " + at + "H" + number(x.to_px) + "'/>" +
              text(x.from_px - 5.0, y.px(v) + 4.0, "end", number(v));
  }
  result += text(0.5 * (x.from_px + x.to_px), y.from_px + 32.0, "middle", plot.x_label);
  result += text(x.from_px - 45.0, y.to_px - 8.0, "start", plot.y_label);
  return result;
}

}  // namespace

std::string escaped(const std::string& words) {
  std::string result;
  for (const char c : words) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else if (c == '\'') {
      result += "&#39;";
    } else if (c == '"') {
      result += "&quot;";
    } else {
      result += c;
    }
  }
  return result;
}

std::string page(const std::string& title, const std::string& body) {
  return "<!doctype html>\n<html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
         "content='width=device-width'><title>" +
         escaped(title) + "</title><style>" + kStyle + "</style></head><body>\n" + body + "</body></html>\n";
}

std::string card(const std::string& content, bool wide) {
  return std::string("<div class='card") + (wide ? " wide" : "") + "'>" + content + "</div>\n";
}

std::string svg(const Plot& plot) {
  Axis x = axis_of(plot, false, 56.0, plot.width_px - 12.0);
  Axis y = axis_of(plot, true, plot.height_px - 40.0, 46.0);
  if (plot.same_scale) make_scales_equal(x, y);
  std::string result = "<svg viewBox='0 0 " + number(plot.width_px) + " " + number(plot.height_px) +
                       "' role='img' aria-label='" + escaped(plot.title) + "'>";
  result += text(x.from_px - 45.0, 16.0, "start", plot.title, "class='title'");
  result += grid(plot, x, y);
  double legend_px = x.to_px;
  for (auto curve = plot.curves.rbegin(); curve != plot.curves.rend(); ++curve) {
    if (curve->name.empty()) continue;
    result += text(legend_px, 34.0, "end", curve->name, fill(curve->colour).c_str());
    legend_px -= 8.0 + 6.6 * static_cast<double>(curve->name.size());
  }
  for (const Curve& curve : plot.curves) result += path(curve, x, y);
  for (const Label& label : plot.labels) {
    result += text(x.px(label.x), y.px(label.y), "middle", label.words, fill(label.colour).c_str());
  }
  return result + "</svg>\n";
}

}  // namespace stilt::plot
