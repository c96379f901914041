#include "firmware/commissioning/json_number.h"

#include <cmath>

namespace stilt::commissioning {

nlohmann::ordered_json json_number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace stilt::commissioning
