#include "firmware/configuration/edit.h"

#include <toml++/toml.h>

#include <algorithm>

#include "firmware/configuration/toml_place.h"

namespace stilt::configuration {
namespace {

/// Where a line of a section can be added: behind its last line that holds a key, or behind its head.
std::size_t end_of_section(std::string_view text, const toml::table& section) {
  toml::source_index last = section.source().begin.line;
  for (auto&& [key, node] : section) last = std::max(last, node.source().end.line);
  const std::size_t line = offset_of(text, {.line = last, .column = 1});
  return std::min(text.find('\n', line), text.size());
}

void add_line(std::string& text, std::size_t at, const std::string& line) { text.insert(at, '\n' + line); }

/// Before the brace that ends an inline table.
void add_inline(std::string& text, const toml::table& section, const std::string& pair) {
  const std::size_t brace = text.rfind('}', offset_of(text, section.source().end) - 1);
  const std::size_t end = text.find_last_not_of(" \t", brace - 1) + 1;
  if (section.empty()) {
    text.replace(end, brace - end, ' ' + pair + ' ');
  } else {
    text.insert(end, ", " + pair);
  }
}

/// A section without head is written with dots, line by line.
bool has_head(std::string_view text, const toml::table& section) {
  return text[offset_of(text, section.source().begin)] == '[';
}

void put(std::string& text, const toml::table& root, const NewValue& value) {
  const std::string line = value.key + " = " + value.value;
  const toml::node* section = root.get(value.section);
  if (section == nullptr || !section->is_table()) {
    if (!text.empty() && text.back() != '\n') text += '\n';
    text += (text.empty() ? "[" : "\n[") + value.section + "]\n" + line + '\n';
    return;
  }
  const toml::table& keys = *section->as_table();
  if (const toml::node* old = keys.get(value.key)) {
    const std::size_t from = offset_of(text, old->source().begin);
    text.replace(from, offset_of(text, old->source().end) - from, value.value);
    return;
  }
  if (keys.is_inline()) return add_inline(text, keys, line);
  add_line(text, end_of_section(text, keys), has_head(text, keys) ? line : value.section + '.' + line);
}

}  // namespace

std::expected<std::string, Diagnostic> with_values(std::string_view toml, std::string_view file,
                                                   std::span<const NewValue> values) {
  std::string text(toml);
  try {
    for (const NewValue& value : values) put(text, toml::parse(text, file), value);
  } catch (const toml::parse_error& error) {
    const toml::source_position place = error.source().begin;
    return std::unexpected(Diagnostic{std::string(file), static_cast<int>(place.line),
                                      static_cast<int>(place.column),
                                      "not valid TOML: " + std::string(error.description())});
  }
  return text;
}

std::vector<std::string> keys_of(std::string_view toml) {
  std::vector<std::string> names;
  try {
    for (auto&& [section, node] : toml::parse(toml)) {
      const toml::table* table = node.as_table();
      if (table == nullptr) continue;
      for (auto&& [key, value] : *table) {
        names.push_back(std::string(section.str()) + '.' + std::string(key.str()));
      }
    }
  } catch (const toml::parse_error&) {
    return {};
  }
  return names;
}

}  // namespace stilt::configuration
