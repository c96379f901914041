#include "host_tools/experiments/table_text.h"

#include <cstdio>

namespace stilt::experiments {

std::string text(const char* format, double value) {
  char buffer[40];
  (void)std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

std::string cell(const Json& value, const char* format, const char* absent) {
  return value.is_null() ? absent : text(format, value.get<double>());
}

Json to_json(const std::optional<Estimate>& estimate) {
  if (!estimate) return nullptr;
  return {{"value", estimate->value}, {"low", estimate->interval.low}, {"high", estimate->interval.high}};
}

std::string estimate_text(const Json& estimate, const char* format) {
  return cell(estimate.at("value"), format) + " (" + cell(estimate.at("low"), format) + " to " +
         cell(estimate.at("high"), format) + ")";
}

}  // namespace stilt::experiments
