#include "firmware/configuration/migrate.h"

#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "firmware/configuration/configuration.h"
#include "firmware/configuration/edit.h"
#include "firmware/configuration/renames.h"
#include "firmware/configuration/toml_place.h"
#include "firmware/robots/robots.h"

namespace stilt::configuration {
namespace {

/// An old name in the text.
struct Found {
  const Rename* rename;
  toml::source_position place;
};

/// Old names of a parsed file in the order of the text. A section that is written with dots on every line has
/// one key node, so only its first line is found.
std::vector<Found> find_old_names(const toml::table& root) {
  std::vector<Found> found;
  for (auto&& [section, node] : root) {
    if (const Rename* rename = find_rename(section.str())) found.push_back({rename, section.source().begin});
    const toml::table* table = node.as_table();
    if (table == nullptr) continue;
    for (auto&& [key, value] : *table) {
      if (const Rename* rename = find_rename(section.str(), key.str())) {
        found.push_back({rename, key.source().begin});
      }
    }
  }
  std::ranges::sort(found, std::less{}, &Found::place);
  return found;
}

Diagnostic diagnostic(std::string_view file, toml::source_position place, std::string message) {
  return {std::string(file), static_cast<int>(place.line), static_cast<int>(place.column),
          std::move(message)};
}

/// Where the file has a key under both names.
std::optional<Diagnostic> conflict(const toml::table& root, std::span<const Found> found,
                                   std::string_view file) {
  for (const Found& one : found) {
    const Rename& rename = *one.rename;
    if (rename.key.empty() || !root[rename.section][rename.now]) continue;
    return diagnostic(file, one.place, to_string(rename) + ", and the file has both; remove one of them");
  }
  return std::nullopt;
}

/// Where the file has a section under both names. Keys with dots may stand beside each other, and others may
/// not.
std::optional<Diagnostic> two_sections(const toml::table& root, std::span<const Found> found,
                                       std::string_view file) {
  for (const Found& one : found) {
    const Rename& rename = *one.rename;
    if (!rename.key.empty() || !root.contains(rename.now)) continue;
    return diagnostic(file, one.place,
                      to_string(rename) + ", and the file has both; move the keys of " +
                          std::string(rename.section) + " to " + std::string(rename.now));
  }
  return std::nullopt;
}

/// The first key whose value would have another meaning under the new name.
std::optional<Diagnostic> value_to_change(std::span<const Found> found, std::string_view file) {
  const auto one = std::ranges::find_if(
      found, [](const Found& candidate) { return !candidate.rename->value_change.empty(); });
  if (one == found.end()) return std::nullopt;
  return diagnostic(file, one->place, to_string(*one->rename) + ", then rename it by hand");
}

}  // namespace

std::expected<Migration, Diagnostic> migrate(std::string_view toml, std::string_view file) {
  Migration migration{std::string(toml), {}};
  std::optional<Diagnostic> both_sections;  // of the text before it was renamed
  while (true) {
    toml::table root;
    try {
      root = toml::parse(migration.text, file);
    } catch (const toml::parse_error& error) {
      if (both_sections) return std::unexpected(std::move(*both_sections));
      return std::unexpected(
          diagnostic(file, error.source().begin, "not valid TOML: " + std::string(error.description())));
    }
    const std::vector<Found> found = find_old_names(root);
    if (found.empty()) return migration;
    if (auto both = conflict(root, found, file)) return std::unexpected(std::move(*both));
    both_sections = two_sections(root, found, file);
    if (auto value = value_to_change(found, file)) return std::unexpected(std::move(*value));
    for (auto one = found.rbegin(); one != found.rend(); ++one) {
      const std::string_view old = one->rename->key.empty() ? one->rename->section : one->rename->key;
      const std::size_t offset = offset_of(migration.text, one->place);
      migration.text.replace(migration.text.find(old, offset), old.size(), one->rename->now);
    }
    for (const Found& one : found) {
      migration.changes.push_back(diagnostic(file, one.place, to_string(*one.rename)));
    }
  }
}

std::string moved(std::string_view toml, std::string_view file, std::string_view other) {
  const auto folder_of = [](std::string_view name) {
    return std::filesystem::absolute(name).lexically_normal().parent_path();
  };
  const auto robot = toml::parse(toml, file)["hardware"]["robot"].value<std::string>();
  if (!robot || !robots::is_file(*robot) || folder_of(file) == folder_of(other)) return std::string(toml);
  const std::string named = robot_in_file(other, (folder_of(file) / *robot).string());
  const NewValue value{"hardware", "robot", '"' + named + '"'};
  return with_values(toml, file, {{value}}).value_or(std::string(toml));
}

}  // namespace stilt::configuration
