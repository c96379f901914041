#pragma once

#include <string>
#include <vector>

namespace stilt::plot {

/// A line of a plot.
struct Curve {
  std::string name;    ///< for the legend
  std::string colour;  ///< of CSS, var(--x) included
  std::vector<double> x, y;
  bool dashed = false;
};

/// Words in a plot, centred at a point of it.
struct Label {
  double x = 0.0, y = 0.0;
  std::string words;
  std::string colour;  ///< as that of a curve
};

/// A plot with frame, ticks, title and legend.
struct Plot {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
  bool same_scale = false;  ///< one unit is as long in both directions
  double width_px = 460.0, height_px = 280.0;
  std::vector<Label> labels = {};
};

/// The plot as an SVG element. Values that are not finite break the line.
[[nodiscard]] std::string svg(const Plot& plot);

/// Text with the characters that HTML reserves replaced.
[[nodiscard]] std::string escaped(const std::string& text);

/// A page of its own, light or dark as the reader's system: `body` within a title and a style that knows the
/// colours --a to --d, --text, --muted, --line, --bad and --good, and the class grid-of-plots for cards.
[[nodiscard]] std::string page(const std::string& title, const std::string& body);

/// A framed box in a grid of plots; a wide one takes the whole row.
[[nodiscard]] std::string card(const std::string& content, bool wide = false);

}  // namespace stilt::plot
