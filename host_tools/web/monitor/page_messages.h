#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "host_tools/web/monitor/sample_source.h"
#include "host_tools/web/monitor/samples.h"
#include "host_tools/web/monitor/web_server.h"

/// What goes between monitor and page, on the WebSocket /live. Text messages are JSON objects with a `type`;
/// binary ones are tables of samples:
///
///   u8 kind, 3 bytes 0, u32 rows, f64 base_time_s, f64 first_number, then rows x columns of f32, row by row
///
/// little endian, 24 bytes of head. The columns of each kind are named in the `hello`; column 0 is the time
/// since base_time_s. The page writes JSON: see page_commands.h.
namespace stilt::monitor {

enum class Table : std::uint8_t { ticks = 1, planner = 2, plan = 3, truth = 4 };

/// First message to a page: what the source is, the supervisor's tables, the columns of the tables.
[[nodiscard]] SharedMessage hello_message(const SampleSource& source, bool has_token);

/// Robot, run, tunables, drawing.
[[nodiscard]] SharedMessage configuration_message(const ConfigurationSample& sample);

[[nodiscard]] SharedMessage supervisor_message(const SupervisorSample& sample);
[[nodiscard]] SharedMessage event_message(const EventSample& sample);
[[nodiscard]] SharedMessage timing_message(const TimingSample& sample);

/// How data arrive.
struct LinkStatus {
  bool received = false;        ///< any message so far
  double silent_s = 0.0;        ///< since the newest tick came in
  std::uint64_t ticks = 0;      ///< received
  std::uint64_t missing = 0;    ///< gaps in the numbers of ticks
  std::uint64_t runs = 0;       ///< seen so far
  std::uint64_t of_others = 0;  ///< samples left out: another controller talks, too
  std::uint64_t not_sent = 0;   ///< to this page, because it does not keep up
};
[[nodiscard]] SharedMessage link_message(const LinkStatus& status);

/// A command's fate, by the page's own number of it.
[[nodiscard]] SharedMessage reply_message(std::uint32_t sequence, bool accepted, const std::string& reason);

/// Tables; at least one sample each.
[[nodiscard]] SharedMessage ticks_message(std::span<const TickSample> ticks);
[[nodiscard]] SharedMessage planner_message(std::span<const PlannerSample> cycles);
[[nodiscard]] SharedMessage plan_message(const PlanSample& plan);
[[nodiscard]] SharedMessage truth_message(std::span<const TruthSample> samples);

}  // namespace stilt::monitor
