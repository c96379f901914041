#include "host_tools/web/monitor/page_messages.h"

#include "firmware/robots/robots.h"
#include "firmware/supervisor/fallback.h"
#include "firmware/supervisor/fault.h"
#include "firmware/supervisor/state.h"
#include "firmware/telemetry/command_arbiter.h"
#include "host_tools/web/monitor/page_tables.h"
#include "mpc_core/model/robot.h"
#include "mpc_core/sqp/solve_status_names.h"

namespace stilt::monitor {
namespace {

using Json = nlohmann::ordered_json;

/// Height of the drawn torso above the hip, in heights of its centre of mass.
constexpr double kTorsoToCom = 1.75;

SharedMessage text(const Json& json) {
  return std::make_shared<const Message>(
      Message{json.dump(-1, ' ', false, Json::error_handler_t::replace), false, false});
}

const char* name(supervisor::Severity severity) {
  constexpr const char* kNames[] = {"warning", "degraded", "latched"};
  return kNames[static_cast<int>(severity)];
}

/// The supervisor's table of faults, in the order of the bits of a FaultSet.
Json faults_json() {
  Json faults = Json::array();
  for (const supervisor::FaultRow& fault : supervisor::kFaultTable) {
    faults.push_back({{"number", fault.number},
                      {"name", fault.name},
                      {"severity", name(fault.severity)},
                      {"reaction", supervisor::name(fault.reaction)},
                      {"cause", fault.cause},
                      {"clears", fault.clears}});
  }
  return faults;
}

template <class Enumeration>
Json names_up_to(Enumeration last) {
  Json names = Json::array();
  for (int k = 0; k <= static_cast<int>(last); ++k) names.push_back(name(static_cast<Enumeration>(k)));
  return names;
}

/// Commands that the robot refuses in that state, and the page does not send, each with the reason.
Json refused_json(supervisor::State state) {
  Json refused = Json::object();
  for (const CommandKind kind : {CommandKind::stand, CommandKind::step, CommandKind::walk, CommandKind::sit,
                                 CommandKind::reset, CommandKind::height, CommandKind::tunable}) {
    const std::string reason = telemetry::wrong_state(kind, state);
    if (!reason.empty()) refused[telemetry::name(kind)] = reason;
  }
  return refused;
}

Json states_json() {
  Json states = Json::array();
  for (std::size_t k = 0; k < supervisor::kStates; ++k) {
    const auto state = static_cast<supervisor::State>(k);
    states.push_back(
        {{"name", name(state)}, {"description", description(state)}, {"refused", refused_json(state)}});
  }
  return states;
}

Json drawing_json(const model::RobotConstants& robot) {
  return {{"torso_length_m", kTorsoToCom * robot.torso_com_height_m},
          {"thigh_length_m", robot.thigh_length_m},
          {"shin_length_m", robot.shin_length_m},
          {"torque_limit_Nm", robot.torque_limit_Nm},
          {"mass_kg", robot.total_mass_kg}};
}

Json tunables_json(const std::vector<Tunable>& tunables) {
  Json list = Json::array();
  for (const Tunable& tunable : tunables) {
    list.push_back({{"name", tunable.name},
                    {"unit", tunable.unit},
                    {"description", tunable.description},
                    {"min", tunable.min},
                    {"max", tunable.max},
                    {"value", tunable.value}});
  }
  return list;
}

}  // namespace

SharedMessage hello_message(const SampleSource& source) {
  return text({{"type", "hello"},
               {"source", source.describe()},
               {"live", source.live()},
               {"states", states_json()},
               {"fallback_levels", names_up_to(supervisor::FallbackLevel::off)},
               {"reactions", names_up_to(supervisor::Reaction::off)},
               {"statuses", sqp::kSolveStatusNames},
               {"gaits", {"stand", "step", "walk"}},
               {"faults", faults_json()},
               {"columns", all_column_names()}});
}

SharedMessage access_message(const Access& access) {
  return text({{"type", "access"},
               {"has_key", access.has_key},
               {"has_token", access.has_token},
               {"key", access.key},
               {"urls", access.urls}});
}

SharedMessage configuration_message(const ConfigurationSample& sample) {
  const auto named = robots::find(sample.robot);  // a URDF file may be on another computer
  const auto robot = named ? named : robots::find(robots::shipped_urdfs().front().name);
  const Json drawn_instead = named ? Json(nullptr) : Json((*robot)->name);
  return text({{"type", "configuration"},
               {"run_id", sample.run_id},
               {"robot", sample.robot},
               {"build", sample.build},
               {"toml", sample.toml},
               {"tick_rate_hz", sample.tick_rate_hz},
               {"plan_rate_hz", sample.plan_rate_hz},
               {"drawing", drawing_json((*robot)->model.constants)},
               {"drawn_instead", drawn_instead},
               {"tunables", tunables_json(sample.tunables)}});
}

SharedMessage supervisor_message(const SupervisorSample& sample) {
  return text({{"type", "supervisor"},
               {"time_s", sample.time_s},
               {"state", sample.state},
               {"fallback_level", sample.fallback_level},
               {"reaction", sample.reaction},
               {"present", sample.present},
               {"latched", sample.latched},
               {"ramp", sample.ramp},
               {"gait", sample.gait},
               {"speed_m_s", sample.speed_m_s},
               {"base_height_m", sample.base_height_m},
               {"commander", sample.commander},
               {"commander_alive", sample.commander_alive},
               {"found", sample.found}});
}

SharedMessage event_message(const EventSample& sample) {
  return text({{"type", "event"},
               {"time_s", sample.time_s},
               {"text", sample.text},
               {"serious", sample.serious},
               {"warning", sample.warning}});
}

SharedMessage timing_message(const TimingSample& sample) {
  Json histograms = Json::array();
  for (const HistogramSample& histogram : sample.histograms) {
    histograms.push_back({{"name", histogram.name},
                          {"deadline_us", histogram.deadline_us},
                          {"p50_us", histogram.p50_us},
                          {"p99_us", histogram.p99_us},
                          {"p999_us", histogram.p999_us},
                          {"max_us", histogram.max_us},
                          {"count", histogram.count},
                          {"upper_edge_us", histogram.upper_edge_us},
                          {"in_bin", histogram.in_bin}});
  }
  return text({{"type", "timing"},
               {"ticks", sample.ticks},
               {"late_ticks", sample.late_ticks},
               {"dropped", sample.dropped},
               {"histograms", histograms}});
}

SharedMessage link_message(const LinkStatus& status) {
  Json talking = Json::array();
  for (const SendingRun& run : status.talking) {
    talking.push_back({{"run_id", run.run_id}, {"robot", run.robot}});
  }
  Json playback;
  if (status.playback) {
    playback = {{"at_s", status.playback->at_s},
                {"length_s", status.playback->length_s},
                {"held", status.playback->held}};
  }
  return text({{"type", "link"},
               {"time_s", status.time_s},
               {"behind_s", status.behind_s},
               {"received", status.received},
               {"silent_s", status.silent_s},
               {"ticks", status.ticks},
               {"emergency_stop", status.emergency_stop},
               {"missing", status.missing},
               {"of_others", status.of_others},
               {"runs", status.runs},
               {"not_sent", status.not_sent},
               {"talking", talking},
               {"refused", status.refused},
               {"playback", playback}});
}

SharedMessage reply_message(std::uint32_t sequence, bool accepted, const std::string& reason, bool proven) {
  return text({{"type", "reply"},
               {"sequence", sequence},
               {"accepted", accepted},
               {"reason", reason},
               {"proven", proven}});
}

}  // namespace stilt::monitor
