#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <vector>

#include "firmware/configuration/schema.h"

namespace stilt::configuration {
namespace {

template <class... Cases>
struct Match : Cases... {
  using Cases::operator()...;
};

std::string quoted(std::string_view word) { return '"' + std::string(word) + '"'; }

std::string kind_of(const Value& value) {
  return std::visit(
      Match{[](double) { return "a number with a fraction"; }, [](long long) { return "a whole number"; },  //
            [](bool) { return "true or false"; }, [](const std::string&) { return "text"; }},
      value);
}

std::string shown(const Value& value) {
  return std::visit(Match{[](double number) { return number_text(number); },
                          [](long long number) { return std::to_string(number); },
                          [](bool flag) { return std::string(flag ? "true" : "false"); },
                          [](const std::string& word) { return quoted(word); }},
                    value);
}

std::string wrong_kind(const Entry& entry, const Value& value, std::string_view wanted) {
  return entry.name() + " must be " + std::string(wanted) + " (" + range_text(entry) + "), not " +
         kind_of(value);
}

std::string out_of_range(const Entry& entry, const Value& value) {
  return entry.name() + " = " + shown(value) + " is outside its range, " + range_text(entry);
}

/// Bytes of the character that begins with this one in UTF-8; 0: none does.
std::size_t character_bytes(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first < 0xe0) return 2;
  if (first >= 0xe0 && first < 0xf0) return 3;
  return first >= 0xf0 && first < 0xf5 ? 4 : 0;
}

/// Whether the text is UTF-8 and stands between the quotes of TOML as it is.
bool is_plain(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    if (first < ' ' || first == 127 || first == '"' || first == '\\') return false;
    const std::size_t bytes = character_bytes(first);
    if (bytes == 0 || bytes > text.size() - i) return false;
    const std::string_view rest = text.substr(i + 1, bytes - 1);
    if (!std::ranges::all_of(rest, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; })) {
      return false;
    }
    i += bytes;
  }
  return true;
}

/// Number of single-character edits that turn one word into the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string Entry::name() const { return std::string(section) + '.' + std::string(key); }

const Entry* find_entry(std::string_view section, std::string_view key) {
  const auto found = std::ranges::find_if(
      entries(), [&](const Entry& entry) { return entry.section == section && entry.key == key; });
  return found == entries().end() ? nullptr : &*found;
}

std::string_view nearest(std::string_view misspelt, std::span<const std::string_view> names) {
  std::string_view best;
  std::size_t best_distance = std::max<std::size_t>(2, misspelt.size() / 3) + 1;
  for (const std::string_view name : names) {
    const std::size_t distance = edit_distance(misspelt, name);
    if (distance < best_distance) {
      best = name;
      best_distance = distance;
    }
  }
  return best;
}

std::string number_text(double value) {
  if (!std::isfinite(value)) return std::isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf";
  char buffer[32];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  std::string text(buffer, end);
  // 1e-06 -> 1e-6: as one would write it.
  if (const std::size_t exponent = text.find('e'); exponent != std::string::npos) {
    const std::size_t digits = exponent + 2;
    if (text[digits] == '0') text.erase(digits, 1);
    if (text[exponent + 1] == '+') text.erase(exponent + 1, 1);
  }
  return text;
}

std::optional<std::string> assign(const Entry& entry, const Value& value, Parameters& parameters) {
  const auto to_real = [&](const RealField& field) -> std::optional<std::string> {
    double number = 0.0;
    if (const auto* real = std::get_if<double>(&value)) {
      number = *real;
    } else if (const auto* whole = std::get_if<long long>(&value)) {
      number = static_cast<double>(*whole);
    } else {
      return wrong_kind(entry, value, "a number");
    }
    const bool inside = number >= field.min && number <= field.max;  // false for NaN
    if (!inside) return out_of_range(entry, value);
    field.set(parameters, number);
    return std::nullopt;
  };
  const auto to_integer = [&](const IntegerField& field) -> std::optional<std::string> {
    const auto* whole = std::get_if<long long>(&value);
    if (whole == nullptr) return wrong_kind(entry, value, "a whole number");
    if (*whole < field.min || *whole > field.max) return out_of_range(entry, value);
    field.set(parameters, static_cast<int>(*whole));
    return std::nullopt;
  };
  const auto to_flag = [&](const FlagField& field) -> std::optional<std::string> {
    const auto* flag = std::get_if<bool>(&value);
    if (flag == nullptr) return entry.name() + " must be true or false, not " + kind_of(value);
    field.set(parameters, *flag);
    return std::nullopt;
  };
  const auto to_choice = [&](const ChoiceField& field) -> std::optional<std::string> {
    const auto* word = std::get_if<std::string>(&value);
    const auto found = word == nullptr ? field.words.end() : std::ranges::find(field.words, *word);
    if (found == field.words.end()) {
      return entry.name() + " must be " + range_text(entry) + ", not " + shown(value);
    }
    field.set(parameters, static_cast<int>(found - field.words.begin()));
    return std::nullopt;
  };
  const auto to_text = [&](const TextField& field) -> std::optional<std::string> {
    const auto* line = std::get_if<std::string>(&value);
    if (line == nullptr)
      return entry.name() + " must be text, " + range_text(entry) + ", not " + kind_of(value);
    if (!is_plain(*line)) {
      return entry.name() + " must be UTF-8 without quotes, backslashes or control characters";
    }
    if (const auto mistake = field.mistake(*line)) return entry.name() + ": " + *mistake;
    field.set(parameters, *line);
    return std::nullopt;
  };
  return std::visit(Match{to_real, to_integer, to_flag, to_choice, to_text}, entry.field);
}

std::string value_text(const Entry& entry, const Parameters& parameters) {
  const auto real = [&](const RealField& field) {
    std::string text = number_text(field.get(parameters));
    if (text.find_first_of(".en") == std::string::npos) text += ".0";
    return text;
  };
  const auto choice = [&](const ChoiceField& field) { return quoted(field.words[field.get(parameters)]); };
  const auto line = [&](const TextField& field) { return quoted(field.get(parameters)); };
  return std::visit(
      Match{real, choice, line,
            [&](const IntegerField& field) { return std::to_string(field.get(parameters)); },
            [&](const FlagField& field) { return std::string(field.get(parameters) ? "true" : "false"); }},
      entry.field);
}

std::string range_text(const Entry& entry) {
  const std::string unit = entry.unit == "1" ? "" : ' ' + std::string(entry.unit);
  const auto choice = [](const ChoiceField& field) {
    std::string text;
    for (std::size_t i = 0; i < field.words.size(); ++i)
      text += (i > 0 ? " or " : "") + quoted(field.words[i]);
    return text;
  };
  return std::visit(Match{[&](const RealField& field) {
                            return number_text(field.min) + " to " + number_text(field.max) + unit;
                          },
                          [&](const IntegerField& field) {
                            return std::to_string(field.min) + " to " + std::to_string(field.max) + unit;
                          },
                          [](const FlagField&) { return std::string("true or false"); }, choice,
                          [](const TextField& field) { return std::string(field.form); }},
                    entry.field);
}

std::string describe(const Entry& entry) {
  const bool pure_number = entry.unit == "1";
  return std::string(entry.description) + ".\n" + range_text(entry) + (pure_number ? ", no unit" : "") +
         "; default " + value_text(entry, Parameters{});
}

}  // namespace stilt::configuration
