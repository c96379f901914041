#pragma once

#include <vector>

#include "firmware/configuration/parameters.h"
#include "host_tools/recording/run_record.h"

namespace stilt::record {

/// Every key of a configuration and its value as TOML, in the order of the file.
[[nodiscard]] std::vector<log::Setting> settings_of(const configuration::Configuration& configuration);

}  // namespace stilt::record
