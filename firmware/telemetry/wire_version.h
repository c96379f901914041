#pragma once

#include <cstdint>

namespace stilt::telemetry {

/// Version of the messages of stilt_msgs.idl. Configuration_::wire_version and the metadata of a record hold
/// it. Release 0.1 has none. Version 2 was that of the development of 0.2.0. Version 3 is frozen, in
/// tests/firmware/telemetry/frozen_fields.txt.
///
/// Every change raises the version. Fields are appended at the end of a message, and none is renamed. A
/// reader skips bytes behind the fields that it has, so that its program can still name both versions. Where
/// it has more fields than were sent, Cyclone drops the message.
inline constexpr std::uint32_t kWireVersion = 3;

}  // namespace stilt::telemetry
