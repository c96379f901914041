#include "firmware/configuration/configuration.h"
#include "firmware/configuration/schema.h"

namespace stilt::configuration {
namespace {

void append_comment(std::string& toml, std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = text.find('\n');
    const std::string_view line = text.substr(0, length);
    toml += line.empty() ? "#" : "# ";
    toml += line;
    toml += '\n';
    text = length == std::string_view::npos ? std::string_view{} : text.substr(length + 1);
  }
}

}  // namespace

std::string to_toml(const Configuration& parameters, std::string_view heading) {
  const Parameters defaults;
  std::string toml;
  append_comment(toml, heading);
  for (const Section& section : sections()) {
    toml += "\n[" + std::string(section.name) + "]\n";
    append_comment(toml, section.description);
    for (const Entry& entry : entries()) {
      if (entry.section != section.name) continue;
      toml += '\n';
      append_comment(toml, describe(entry));
      toml += std::string(entry.key) + " = " + value_text(entry, parameters) + '\n';
    }
  }
  return toml;
}

}  // namespace stilt::configuration
