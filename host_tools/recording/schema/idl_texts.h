#pragma once

#include <string_view>

namespace stilt::schema {

extern const std::string_view kRos2Idl;   ///< firmware/telemetry/ros2.idl
extern const std::string_view kStiltIdl;  ///< firmware/telemetry/stilt_msgs.idl

}  // namespace stilt::schema
