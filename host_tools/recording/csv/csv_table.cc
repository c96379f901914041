#include "host_tools/recording/csv/csv_table.h"

#include <charconv>
#include <functional>
#include <ostream>

namespace stilt::csv {
namespace {

using Json = nlohmann::ordered_json;
using Use = std::function<void(const std::string& name, const Json& value)>;

/// Calls `use` for every value of a row that is no object, with its full name.
void visit(const Json& row, const std::string& prefix, const Use& use) {
  for (const auto& [key, value] : row.items()) {
    if (value.is_object()) {
      visit(value, prefix + key + '.', use);
    } else {
      use(prefix + key, value);
    }
  }
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char letter : text) {
    if (letter == '"') cell.push_back('"');
    cell.push_back(letter);
  }
  cell.push_back('"');
  return cell;
}

std::string cell(const Json& value) {
  if (value.is_string()) return quoted(value.get<std::string>());
  if (value.is_number_float()) {
    char text[40];
    const auto end = std::to_chars(text, text + sizeof text, value.get<double>()).ptr;
    return {text, end};
  }
  return quoted(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

Table::Table(const std::string& path) : file_(path) {}

void Table::add(const Json& row) {
  std::vector<std::string> names, cells;
  visit(row, "", [&](const std::string& name, const Json& value) {
    if (!named_) names.push_back(quoted(name));
    cells.push_back(cell(value));
  });
  if (!named_) write(names);
  named_ = true;
  write(cells);
}

void Table::write(const std::vector<std::string>& cells) {
  std::ostream& text = file_.text();
  for (std::size_t i = 0; i < cells.size(); ++i) text << (i > 0 ? "," : "") << cells[i];
  text << '\n';
}

}  // namespace stilt::csv
