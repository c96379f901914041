#pragma once

#include <CLI/App.hpp>
#include <string>

namespace stilt::cli {

/// Options of `stilt config migrate`.
struct ConfigOptions {
  std::string file;
  std::string out;  ///< empty: the file is rewritten in place
};

/// Adds `config` with its subcommand `migrate` to the program; its options end up in `options`.
CLI::App* add_config_command(CLI::App& program, ConfigOptions& options);

/// Rewrites a configuration file under the names of this release and prints what was renamed. A file without
/// old names is left as it is. Returns exit status 0. Throws UsageError, one sentence, for a file that cannot
/// be read, is not TOML or cannot be written.
[[nodiscard]] int run_config(const ConfigOptions& options);

}  // namespace stilt::cli
