#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host_tools/web/monitor/page_messages.h"

namespace stilt::monitor {

static_assert(std::endian::native == std::endian::little, "tables are sent as they lie in memory");

/// Bytes before the rows.
inline constexpr std::size_t kTableHead_bytes = 24;

/// A column of a table: its name on the page and the source of its values.
template <class Sample>
struct Column {
  std::string name;
  std::function<double(const Sample&, std::size_t index)> value;
  std::size_t width = 1;  ///< number of values; `index` counts them, and they are named name0, name1, ...
};

/// The message of `samples`: the time since the first sample, then the given columns.
template <class Sample>
SharedMessage table_message(Table table, double base_time_s, std::uint64_t first_number,
                            std::span<const Sample> samples, const std::vector<Column<Sample>>& columns) {
  std::string bytes(kTableHead_bytes, '\0');
  bytes[0] = static_cast<char>(table);
  const auto rows = static_cast<std::uint32_t>(samples.size());
  const auto number = static_cast<double>(first_number);
  std::memcpy(bytes.data() + 4, &rows, sizeof rows);
  std::memcpy(bytes.data() + 8, &base_time_s, sizeof base_time_s);
  std::memcpy(bytes.data() + 16, &number, sizeof number);
  const auto append = [&bytes](double value) {
    const auto narrow = static_cast<float>(value);
    char raw[sizeof narrow];
    std::memcpy(raw, &narrow, sizeof narrow);
    bytes.append(raw, sizeof narrow);
  };
  for (const Sample& sample : samples) {
    append(sample.time_s - base_time_s);
    for (const Column<Sample>& column : columns) {
      for (std::size_t k = 0; k < column.width; ++k) append(column.value(sample, k));
    }
  }
  return std::make_shared<const Message>(Message{std::move(bytes), true, true});
}

/// Names of all columns, the time first.
template <class Sample>
nlohmann::ordered_json column_names(const std::vector<Column<Sample>>& columns) {
  auto names = nlohmann::ordered_json::array({"time_s"});
  for (const Column<Sample>& column : columns) {
    for (std::size_t k = 0; k < column.width; ++k) {
      names.push_back(column.width == 1 ? column.name : column.name + std::to_string(k));
    }
  }
  return names;
}

}  // namespace stilt::monitor
