#include "firmware/commissioning/values_report.h"

namespace stilt::commissioning {

std::string values_text(std::span<const configuration::NewValue> values) {
  std::string text;
  for (const configuration::NewValue& value : values) {
    text += "  " + value.section + '.' + value.key + " = " + value.value + '\n';
  }
  return text;
}

nlohmann::ordered_json values_json(std::span<const configuration::NewValue> values) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const configuration::NewValue& value : values) json[value.section + '.' + value.key] = value.value;
  return json;
}

}  // namespace stilt::commissioning
