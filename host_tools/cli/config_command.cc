#include "host_tools/cli/config_command.h"

#include <cstdio>
#include <string_view>

#include "firmware/configuration/migrate.h"
#include "firmware/diagnostics/input_file.h"
#include "firmware/diagnostics/output_file.h"
#include "host_tools/cli/usage_error.h"

namespace stilt::cli {
namespace {

std::string read(const std::string& path) {
  auto text = diagnostics::read_file(path);
  if (!text) throw UsageError(path + ": cannot be read (" + text.error() + "); name a configuration file");
  return *std::move(text);
}

void write(const std::string& path, std::string_view text) {
  std::string reason = diagnostics::why_not_writable(path);
  if (reason.empty()) {
    const auto written = diagnostics::write_file(path, text);
    if (written) return;
    reason = written.error();
  }
  throw UsageError(path + ": cannot be written (" + reason +
                   "); name a file in an existing, writable folder");
}

}  // namespace

CLI::App* add_config_command(CLI::App& program, ConfigOptions& options) {
  CLI::App* config = program.add_subcommand("config", "configuration files");
  config->require_subcommand(1);
  CLI::App* migrate =
      config->add_subcommand("migrate", "renames the keys of an earlier release in a configuration file");
  migrate->add_option("FILE", options.file, "configuration file, rewritten in place")->required();
  migrate->add_option("--out", options.out, "file to write instead; - is standard output");
  migrate->footer(
      "Comments, order and values stay. In another folder a relative URDF of hardware.robot is named by its\n"
      "path.\n"
      "Exit status: 0 done or nothing to rename, 2 the file cannot be read or written, is not TOML, has a\n"
      "key or a section under both names, or has a key whose unit has changed.");
  return config;
}

int run_config(const ConfigOptions& options) {
  const auto migration = configuration::migrate(read(options.file), options.file);
  if (!migration) throw UsageError(to_string(migration.error()));
  if (!options.out.empty()) {
    const bool has_folder = options.out != "-";
    write(options.out,
          has_folder ? configuration::moved(migration->text, options.file, options.out) : migration->text);
  } else if (!migration->changes.empty()) {
    write(options.file, migration->text);
  }
  std::FILE* report = options.out == "-" ? stderr : stdout;
  if (migration->changes.empty()) std::fprintf(report, "%s: nothing to rename\n", options.file.c_str());
  for (const configuration::Diagnostic& change : migration->changes) {
    std::fprintf(report, "%s\n", to_string(change).c_str());
  }
  return 0;
}

}  // namespace stilt::cli
