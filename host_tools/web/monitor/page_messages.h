#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_tools/web/monitor/sample_source.h"
#include "host_tools/web/monitor/samples.h"
#include "host_tools/web/monitor/web_server.h"

/// Messages between monitor and page on the WebSocket /live. Text messages are JSON objects with a `type`;
/// binary messages are tables of samples:
///
///   u8 kind, 3 bytes 0, u32 rows, f64 base_time_s, f64 first_number, then rows x columns of f32, row by row
///
/// All numbers are little endian; the head has 24 bytes. `hello` names the columns of each kind; column 0 is
/// the time since base_time_s. The page writes JSON: see page_commands.h.
namespace stilt::monitor {

enum class Table : std::uint8_t { ticks = 1, planner = 2, plan = 3, truth = 4 };

/// First message to a page: the source, the supervisor's tables, the columns of the tables.
[[nodiscard]] SharedMessage hello_message(const SampleSource& source);

/// What a page may do, and for one with the monitor's key: that key, and the addresses of the monitor's page
/// for other machines.
struct Access {
  bool has_key = false;    ///< it may use the tokens that the monitor has
  bool has_token = false;  ///< the monitor has the token of the run that is shown
  std::string key;         ///< empty for a page without it
  std::vector<std::string> urls;
};
[[nodiscard]] SharedMessage access_message(const Access& access);

/// Message with robot, run, tunables and drawing.
[[nodiscard]] SharedMessage configuration_message(const ConfigurationSample& sample);

[[nodiscard]] SharedMessage supervisor_message(const SupervisorSample& sample);
[[nodiscard]] SharedMessage event_message(const EventSample& sample);
[[nodiscard]] SharedMessage timing_message(const TimingSample& sample);

/// State of the connection to the source.
struct LinkStatus {
  double time_s = 0.0;          ///< of the monitor's clock, when it is sent; pages return the newest
  double behind_s = 0.0;        ///< age of the one in the newest sign of life of this page, when that came
  bool received = false;        ///< whether any message has been received
  double silent_s = 0.0;        ///< since the newest tick was received
  std::uint64_t ticks = 0;      ///< received
  std::string emergency_stop;   ///< of the newest tick, hal::name(EmergencyStopState)
  std::uint64_t missing = 0;    ///< gaps in the numbers of ticks
  std::uint64_t runs = 0;       ///< received so far
  std::uint64_t of_others = 0;  ///< samples ignored because another controller is publishing too
  std::uint64_t not_sent = 0;   ///< messages not sent to this page because it is too slow
  std::vector<SendingRun> talking;   ///< controllers that send now
  std::string refused;               ///< SampleSource::refused
  std::optional<Playback> playback;  ///< of a record
};
[[nodiscard]] SharedMessage link_message(const LinkStatus& status);

/// Result of a command, with the page's own number of it.
/// @param proven  false: a refusal of somebody without the command's token; the robot's own reply may follow
[[nodiscard]] SharedMessage reply_message(std::uint32_t sequence, bool accepted, const std::string& reason,
                                          bool proven = true);

/// Messages of tables; each needs at least one sample.
[[nodiscard]] SharedMessage ticks_message(std::span<const TickSample> ticks);
[[nodiscard]] SharedMessage planner_message(std::span<const PlannerSample> cycles);
[[nodiscard]] SharedMessage plan_message(const PlanSample& plan);
[[nodiscard]] SharedMessage truth_message(std::span<const TruthSample> samples);

}  // namespace stilt::monitor
