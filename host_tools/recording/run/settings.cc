#include "host_tools/recording/run/settings.h"

#include "firmware/configuration/schema.h"

namespace stilt::record {

std::vector<log::Setting> settings_of(const configuration::Configuration& configuration) {
  std::vector<log::Setting> settings;
  for (const configuration::Entry& entry : configuration::entries()) {
    settings.push_back({entry.name(), configuration::value_text(entry, configuration)});
  }
  return settings;
}

}  // namespace stilt::record
