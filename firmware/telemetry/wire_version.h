#pragma once

#include <cstdint>

namespace stilt::telemetry {

/// Version of the messages of stilt_msgs.idl. Configuration_::wire_version and the metadata of a record hold
/// it. Release 0.1 has none. Version 2 was that of the development of 0.2.0. Version 3 is frozen, in
/// tests/firmware/telemetry/frozen_fields.txt.
///
/// A field appended at the end of a message keeps the version, because readers skip bytes behind the fields
/// they have. The version rises when a field is removed or renamed, and when its type, unit, place or
/// meaning changes. It rises with every change of a nested structure, too (Tunable_, Histogram_). Why:
/// docs/decisions/0009-telemetry.md.
inline constexpr std::uint32_t kWireVersion = 3;

}  // namespace stilt::telemetry
