#pragma once

#include <string_view>

/// Type hashes of the topics. Written by toolchain/ros2_messages; see
/// docs/decisions/0032-python-and-ros2.md.
namespace stilt::telemetry {

/// Hash of a type, by which ROS 2 compares types.
struct TypeHash {
  std::string_view ros_type;
  std::string_view hash;  ///< RIHS01 of REP 2016
};

// clang-format off
inline constexpr TypeHash kTypeHashes[] = {
    {"diagnostic_msgs/msg/DiagnosticArray", "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
    {"geometry_msgs/msg/Twist", "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"},
    {"nav_msgs/msg/Odometry", "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
    {"sensor_msgs/msg/JointState", "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"},
    {"stilt_msgs/msg/Command", "RIHS01_cc05d4c7fc65e8842bd2b1b850e763bb9054361f1704cd93053723a788438a91"},
    {"stilt_msgs/msg/CommandReply", "RIHS01_039d8de3c398952748b7d1355ef02a49e492c8b741b7dcaad01a0ab98e13714a"},
    {"stilt_msgs/msg/Configuration", "RIHS01_8836ce213b01c93373b077644eafd33024d0d773f3b45e003dba731f684b064f"},
    {"stilt_msgs/msg/Event", "RIHS01_22a245fb42beccad14c5c602c46dd036f54e7ce8e1bba882aa5ea95292867fc2"},
    {"stilt_msgs/msg/Plan", "RIHS01_9160ba77f0d7f8c437a23eadb9a19cf61001c094fb49e0f5784c0b6a6260454b"},
    {"stilt_msgs/msg/PlannerCycle", "RIHS01_41c75f40dc222eef706d2fc92edf7504db5a45627348c545258ac1843e94a5b2"},
    {"stilt_msgs/msg/Simulation", "RIHS01_41d3f2a731487a10962cb047a500c1363219773c1e9e11fc80c6d126cbff268e"},
    {"stilt_msgs/msg/Supervisor", "RIHS01_3a05083b5494bc94bc721f896c6c044c252acefc81fd806eb007e3c115bb851a"},
    {"stilt_msgs/msg/TickBatch", "RIHS01_dcd9d181f599fff11da29e6ed4fefaf64568d501ac2f21abf6b524188b3c943b"},
    {"stilt_msgs/msg/Timing", "RIHS01_4f12aa902ca80e86ca2c476d3937d03836b21892865f8f12ef2e84349dd01205"},
    {"stilt_msgs/msg/Tuning", "RIHS01_b767c84fad588e3ba0ea49f98da99ece103f51d849c856775155ab19d51810c6"},
};
// clang-format on

}  // namespace stilt::telemetry
