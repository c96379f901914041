#pragma once

#include <span>

#include "firmware/configuration/schema.h"

/// Parts of the schema's table that stand in files of their own.
namespace stilt::configuration {

[[nodiscard]] std::span<const Section> hardware_sections();
[[nodiscard]] std::span<const Entry> hardware_entries();
[[nodiscard]] std::span<const Section> supervisor_sections();
[[nodiscard]] std::span<const Entry> supervisor_entries();
[[nodiscard]] std::span<const Section> runtime_sections();
[[nodiscard]] std::span<const Entry> runtime_entries();
[[nodiscard]] std::span<const Section> telemetry_sections();
[[nodiscard]] std::span<const Entry> telemetry_entries();

}  // namespace stilt::configuration
