#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "firmware/configuration/parameters.h"

/// The table of everything tunable. One row drives parsing, checks, overrides and the comments of the files.
namespace stilt::configuration {

using Parameters = Configuration;

/// A real number in [min, max].
struct RealField {
  const double& (*get)(const Parameters&);
  void (*set)(Parameters&, double);
  double min;
  double max;
};

/// A whole number in [min, max].
struct IntegerField {
  const int& (*get)(const Parameters&);
  void (*set)(Parameters&, int);
  int min;
  int max;
};

/// true or false.
struct FlagField {
  const bool& (*get)(const Parameters&);
  void (*set)(Parameters&, bool);
};

/// One of a few words; the index of a word is the value of the enumerator.
struct ChoiceField {
  int (*get)(const Parameters&);
  void (*set)(Parameters&, int);
  const void* (*address)(const Parameters&);
  std::size_t size;  ///< of the field, bytes
  std::span<const std::string_view> words;
};

/// A line of text with a form of its own, without quotes, backslashes and control characters.
struct TextField {
  const std::string& (*get)(const Parameters&);
  void (*set)(Parameters&, const std::string&);
  std::string_view form;  ///< what it may be, for people
  std::optional<std::string> (*mistake)(const std::string&);
};

using Field = std::variant<RealField, IntegerField, FlagField, ChoiceField, TextField>;

/// A value as a file or an override gives it.
using Value = std::variant<double, long long, bool, std::string>;

/// A key of the configuration file.
struct Entry {
  std::string_view section;
  std::string_view key;
  std::string_view unit;         ///< "1" for a pure number, empty for flags and words
  std::string_view description;  ///< one sentence without a full stop
  Field field;

  /// "section.key".
  [[nodiscard]] std::string name() const;
};

/// A section of the configuration file.
struct Section {
  std::string_view name;
  std::string_view description;
};

/// Sections in the order of the file.
[[nodiscard]] std::span<const Section> sections();

/// All entries; those of a section stand together, in the order of the file.
[[nodiscard]] std::span<const Entry> entries();

/// The entry of that name, or nullptr.
[[nodiscard]] const Entry* find_entry(std::string_view section, std::string_view key);

/// The known name nearest to a misspelt one, empty when none is near. `names`: candidates.
[[nodiscard]] std::string_view nearest(std::string_view misspelt, std::span<const std::string_view> names);

/// Sets the entry's field. Returns what is wrong with the value, nothing when it was set.
[[nodiscard]] std::optional<std::string> assign(const Entry& entry, const Value& value,
                                                Parameters& parameters);

/// The field's value as TOML.
[[nodiscard]] std::string value_text(const Entry& entry, const Parameters& parameters);

/// What a value may be, with its unit: "0.1 to 2 s", "true or false", "\"rk2\" or \"rk4\"".
[[nodiscard]] std::string range_text(const Entry& entry);

/// Two lines: the description, then range, unit and default.
[[nodiscard]] std::string describe(const Entry& entry);

/// Shortest decimal number that reads back the same.
[[nodiscard]] std::string number_text(double value);

}  // namespace stilt::configuration
