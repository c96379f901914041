#include "firmware/program/outcome.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>
#include <span>

#include "firmware/commissioning/json_text.h"
#include "firmware/control_loop/joint_names.h"
#include "firmware/diagnostics/event_text.h"
#include "firmware/telemetry/telemetry_node.h"

namespace stilt::program {
namespace {

using control_loop::Event;

nlohmann::ordered_json json_of(const diagnostics::Percentiles& percentiles) {
  return {{"p50", percentiles.p50_us},
          {"p99", percentiles.p99_us},
          {"p999", percentiles.p999_us},
          {"max", percentiles.max_us}};
}

/// Joint or bus, driver fault, condition and numbers where the fault has them.
nlohmann::ordered_json json_of(const ReportedFault& fault) {
  nlohmann::ordered_json json = {
      {"name", fault.name}, {"time_s", fault.time_s}, {"reaction", fault.reaction}, {"count", fault.count}};
  if (std::isfinite(fault.over_s)) json["over_s"] = fault.over_s;
  const supervisor::FaultDetail& found = fault.found;
  if (found.joint >= 0) json["joint"] = control_loop::kJointNames[static_cast<std::size_t>(found.joint)];
  if (found.driver_fault != hal::DriverFault::none) {
    json["driver_fault"] = hal::name(found.driver_fault);
    json["fault_code"] = found.fault_code;
  }
  if (!std::isnan(found.limit)) {
    json["value"] = found.value;
    json["limit"] = found.limit;
    json["unit"] = found.unit;
  }
  if (found.bus >= 0) json["bus"] = found.bus;
  if (*found.condition != '\0') json["condition"] = found.condition;
  return json;
}

void say(double time_s, const std::string& text) {
  std::fprintf(stderr, "%9.3f s  %s\n", time_s, text.c_str());
}

void take_wait(double time_s, const std::string& text, Outcome& outcome) {
  outcome.waits = text;
  say(time_s, text);
}

/// Since the last reset; nullptr: there is none.
ReportedFault* recent_entry(const char* name, Outcome& outcome) {
  const auto recent = std::span(outcome.faults).subspan(outcome.faults_before_reset);
  const auto entry = std::ranges::find(recent, name, &ReportedFault::name);
  return entry == recent.end() ? nullptr : &*entry;
}

void take_fault(const Event& event, Outcome& outcome) {
  const supervisor::FaultRow& row = supervisor::row(event.fault);
  if (ReportedFault* entry = recent_entry(row.name, outcome)) {
    ++entry->count;
    entry->over_s = kNotKnown;
    return;
  }
  const char* reaction = supervisor::name(row.reaction);
  outcome.faults.push_back({row.name, event.time_s, reaction, 1, kNotKnown, event.found});
  say(event.time_s, std::string("fault ") + row.name + ": " + row.cause +
                        diagnostics::found_text(event.found) + "; reaction: " + reaction);
}

/// Said once per entry: a warning may come and go in every tick.
void take_fault_over(const Event& event, Outcome& outcome) {
  const char* name = supervisor::name(event.fault);
  const auto entry =
      std::ranges::find(outcome.faults.rbegin(), outcome.faults.rend(), name, &ReportedFault::name);
  if (entry == outcome.faults.rend()) return;
  entry->over_s = event.time_s;
  if (entry->count > 1) return;
  say(event.time_s, std::string("fault ") + name + diagnostics::over_text(event.fault));
}

void take_state(const Event& event, Outcome& outcome) {
  const std::string state = supervisor::name(event.state);
  const bool is_off = event.state == supervisor::State::off;
  if (outcome.state == supervisor::name(supervisor::State::fault) && !is_off) {
    outcome.faults_before_reset = outcome.faults.size();
  }
  if (!is_off) outcome.last_state = state;
  outcome.state = state;
  say(event.time_s, state);
}

}  // namespace

void take_events(control_loop::EventRing& events, Outcome& outcome,
                 telemetry::TelemetryNode* telemetry_node) {
  while (const Event* event = events.front()) {
    if (telemetry_node != nullptr) telemetry_node->event(*event);
    switch (event->kind) {
      case Event::Kind::state:
        take_state(*event, outcome);
        break;
      case Event::Kind::fault:
        take_fault(*event, outcome);
        break;
      case Event::Kind::fault_over:
        take_fault_over(*event, outcome);
        break;
      case Event::Kind::waits_for_pose:
      case Event::Kind::lost_stance:
      case Event::Kind::stopped_waiting:
        take_wait(event->time_s, diagnostics::pose_text(*event), outcome);
        break;
      case Event::Kind::bring_up_failed:
        take_wait(event->time_s, diagnostics::bring_up_text(event->bring_up), outcome);
        break;
    }
    events.pop();
  }
}

void take_end(const LastTick& last, std::uint64_t dropped, Outcome& outcome) {
  outcome.state = supervisor::name(last.state);
  outcome.last_state = supervisor::name(last.last_state);
  outcome.dropped_events = dropped;
  if (dropped == 0) return;
  say(last.time_s,
      std::to_string(dropped) +
          " events were lost, because a terminal, a disk or a busy processor held up their report");
  for (const supervisor::FaultRow& row : supervisor::kFaultTable) {
    if (!last.latched.has(row.fault) || recent_entry(row.name, outcome) != nullptr) continue;
    const char* reaction = supervisor::name(row.reaction);
    outcome.faults.push_back({row.name, kNotKnown, reaction, 1, kNotKnown, {}});
    say(last.time_s, std::string("fault ") + row.name + ": " + row.cause + "; reaction: " + reaction +
                         "; its event is among the lost ones");
  }
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text.data();
}

std::string to_json(const Outcome& outcome) {
  nlohmann::ordered_json json;
  json["started"] = outcome.started;
  json["commit"] = outcome.commit;
  if (outcome.run_id != 0) json["run_id"] = outcome.run_id;
  json["state"] = outcome.state;
  json["last_state"] = outcome.last_state;
  json["faults"] = nlohmann::ordered_json::array();
  for (const ReportedFault& fault : outcome.faults) {
    json["faults"].push_back(json_of(fault));
  }
  json["dropped_events"] = outcome.dropped_events;
  json["ticks"] = outcome.ticks;
  json["late_ticks"] = outcome.late_ticks;
  json["missed_periods"] = outcome.missed_periods;
  json["plans"] = outcome.plans;
  json["wakeup_us"] = json_of(outcome.wakeup_latency_us);
  json["execution_us"] = json_of(outcome.execution_us);
  json["bus_round_trip_us"] = json_of(outcome.bus_round_trip_us);
  json["solve_us"] = json_of(outcome.solve_us);
  json["heap_allocations"] = outcome.heap_allocations;
  json["page_faults"] = outcome.page_faults;
  json["idle_states"] = outcome.idle_states;
  if (outcome.not_realtime.empty()) {
    json["realtime"] = true;
  } else {
    json["realtime"] = outcome.not_realtime;
  }
  if (!outcome.error.empty()) json["error"] = outcome.error;
  return commissioning::json_text(json);
}

}  // namespace stilt::program
