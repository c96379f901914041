#include "host_tools/recording/schema/message_types.h"

#include <algorithm>

#include "host_tools/recording/schema/idl_texts.h"

namespace stilt::schema {

bool is_basic(const std::string& type) {
  static const std::vector<std::string> kBasic = {"bool",   "int8",    "uint8",   "int16",
                                                  "uint16", "int32",   "uint32",  "int64",
                                                  "uint64", "float32", "float64", "string"};
  return std::ranges::find(kBasic, type) != kBasic.end();
}

const MessageTypes& own_messages() {
  static const MessageTypes types = parse_idl(std::string(kRos2Idl) + std::string(kStiltIdl));
  return types;
}

}  // namespace stilt::schema
