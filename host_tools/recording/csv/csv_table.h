#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host_tools/recording/csv/table_file.h"

namespace stilt::csv {

/// A table of comma-separated values that grows row by row. The first row names the columns; nested fields
/// have dots, "header.stamp.sec". Numbers are the shortest that read back the same; a list is one cell of
/// JSON.
class Table {
 public:
  /// Throws std::runtime_error, one sentence, when the file cannot be written.
  explicit Table(const std::string& path);

  /// Adds a row. All rows are objects with the same fields.
  void add(const nlohmann::ordered_json& row);

  /// Closes the file. Throws std::runtime_error, one sentence, when a part was not written.
  void close() { file_.close(); }

  /// Gives the closed file its name: TableFile::place().
  void place() { file_.place(); }

 private:
  void write(const std::vector<std::string>& cells);

  TableFile file_;
  bool named_ = false;
};

}  // namespace stilt::csv
