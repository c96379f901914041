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
  bool dots = false;  ///< points without a line between them
};

/// Text in a plot, centred at a point.
struct Label {
  double x = 0.0, y = 0.0;
  std::string words;
  std::string colour;  ///< like that of a curve
};

/// A plot with frame, ticks, title and legend.
struct Plot {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
  bool same_scale = false;  ///< a unit has the same length in both directions
  double width_px = 460.0, height_px = 280.0;
  std::vector<Label> labels = {};
};

/// The plot as an SVG element. Non-finite values interrupt the line.
[[nodiscard]] std::string svg(const Plot& plot);

/// The text with the reserved characters of HTML replaced.
[[nodiscard]] std::string escaped(const std::string& text);

/// A self-contained page, light or dark like the reader's system: `body` with a title and a style. The style
/// has the colours --a to --d, --text, --muted, --line, --bad and --good, and the class grid-of-plots for
/// cards.
[[nodiscard]] std::string page(const std::string& title, const std::string& body);

/// A framed box in a grid of plots; a wide one fills the row.
[[nodiscard]] std::string card(const std::string& content, bool wide = false);

}  // namespace stilt::plot
