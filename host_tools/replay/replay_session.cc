#include "host_tools/replay/replay_session.h"

#include "firmware/configuration/configuration.h"
#include "firmware/program/configure_cycles.h"

namespace stilt::replay {
namespace {

constexpr std::uint64_t kProgressEvery = 1000;

Outcome failed(const std::string& problem) {
  Outcome outcome;
  outcome.problem = problem;
  return outcome;
}

}  // namespace

Outcome replay_session(const std::string& path, const SessionRecord& session,
                       const std::function<void(std::uint64_t)>& progress) {
  if (!session.configured) {
    return failed("its configuration is missing in the record; record from before stiltd ends");
  }
  const std::string source = "the recorded configuration";
  const auto configuration = configuration::parse(session.configuration, source);
  if (!configuration) {
    return failed(source + " is refused by this program: " + to_string(configuration.error().front()));
  }
  Replay replay(session.cycles, [](std::uint32_t) { return std::nullopt; });
  const auto ready = program::configure_cycles(*configuration, source, replay.planner(), replay.torque());
  if (!ready) return failed(ready.error());
  for_each_tick(path, session.number, [&](const diagnostics::TickRecord& tick) {
    if (progress && tick.tick % kProgressEvery == 0) progress(tick.tick);
    return replay.run(tick);
  });
  Outcome outcome = replay.outcome();
  if (outcome.ticks == 0 && !outcome.difference && outcome.problem.empty()) {
    outcome.problem = "the record holds no ticks of it";
  }
  return outcome;
}

}  // namespace stilt::replay
