#pragma once

#include <cstdint>

namespace stilt::telemetry {

/// Version of the messages of stilt_msgs.idl. Configuration_::wire_version and the metadata of a record hold
/// it. Release 0.1 has no version. Release 0.2.0 will have version 2: until then it may still change, and
/// from then on it is frozen.
///
/// A field appended at the end of a message keeps the version, because readers skip bytes behind the fields
/// they have. The version rises when a field is removed or renamed, and when its type, unit, place or
/// meaning changes. It rises with every change of a nested structure, too (Tunable_, Histogram_). Why:
/// docs/decisions/0009-telemetry.md.
inline constexpr std::uint32_t kWireVersion = 2;

}  // namespace stilt::telemetry
