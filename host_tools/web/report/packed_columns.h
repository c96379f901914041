#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace stilt::report {

/// RFC 4648 base 64 with padding.
[[nodiscard]] std::string encode_base64(std::span<const unsigned char> bytes);

/// A table of numbers in a form that a browser reads fast. All columns stand in one base-64 string, one after
/// another, each an array of little-endian float32. A named group has one or more columns.
class PackedColumns {
 public:
  explicit PackedColumns(std::size_t rows) : rows_(rows) {}

  /// Appends `width` columns. `value(row, column)` is the number, in the unit stated in `name`.
  template <typename Value>
  void add(const std::string& name, int width, const Value& value) {
    groups_.push_back({{"name", name}, {"width", width}});
    for (int column = 0; column < width; ++column) {
      for (std::size_t row = 0; row < rows_; ++row) append(static_cast<double>(value(row, column)));
    }
  }

  /// The table as {"rows": n, "groups": [{"name", "width"}], "float32_base64": "..."}.
  [[nodiscard]] nlohmann::ordered_json json() const;

 private:
  /// Rounds to float32; values out of its range become infinity.
  void append(double value);

  std::size_t rows_;
  nlohmann::ordered_json groups_ = nlohmann::ordered_json::array();
  std::vector<unsigned char> bytes_;
};

}  // namespace stilt::report
