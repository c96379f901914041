#include "host_tools/cli/config_command.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include "firmware/configuration/migrate.h"
#include "firmware/diagnostics/input_file.h"
#include "host_tools/cli/usage_error.h"

namespace stilt::cli {
namespace {

namespace fs = std::filesystem;

std::string read(const std::string& path) {
  auto text = diagnostics::read_file(path);
  if (!text) throw UsageError(path + ": cannot be read (" + text.error() + "); name a configuration file");
  return *std::move(text);
}

/// Writes a temporary beside the file and renames it, so that the file is the old one or the new one, whole.
/// A symbolic link stays one, and permissions stay.
void replace(const std::string& path, std::string_view text) {
  std::error_code failed;
  const fs::path target = fs::weakly_canonical(path, failed);
  const fs::path temporary = target.string() + ".migrated";
  std::ofstream stream(temporary, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw UsageError(path + ": cannot be written: " + std::strerror(errno));
  if (fs::exists(target, failed)) fs::permissions(temporary, fs::status(target).permissions(), failed);
  fs::rename(temporary, target, failed);
  if (failed) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw UsageError(path + ": cannot be written: " + failed.message());
  }
}

}  // namespace

CLI::App* add_config_command(CLI::App& program, ConfigOptions& options) {
  CLI::App* config = program.add_subcommand("config", "configuration files");
  config->require_subcommand(1);
  CLI::App* migrate =
      config->add_subcommand("migrate", "renames the keys of an earlier release in a configuration file");
  migrate->add_option("FILE", options.file, "configuration file, rewritten in place")->required();
  migrate->add_option("--out", options.out, "file to write instead");
  migrate->footer(
      "Comments, order and values stay.\n"
      "Exit status: 0 done or nothing to rename, 2 the file cannot be read or written, is not TOML, has a\n"
      "key under both names, or has a key whose unit has changed.");
  return config;
}

int run_config(const ConfigOptions& options) {
  const auto migration = configuration::migrate(read(options.file), options.file);
  if (!migration) throw UsageError(to_string(migration.error()));
  if (!options.out.empty()) {
    replace(options.out, migration->text);
  } else if (!migration->changes.empty()) {
    replace(options.file, migration->text);
  }
  if (migration->changes.empty()) std::printf("%s: nothing to rename\n", options.file.c_str());
  for (const configuration::Diagnostic& change : migration->changes) {
    std::printf("%s\n", to_string(change).c_str());
  }
  return 0;
}

}  // namespace stilt::cli
