#pragma once

#include "firmware/controller/cycle_record.h"
#include "firmware/controller/events.h"
#include "firmware/controller/messages.h"
#include "firmware/diagnostics/tick_record.h"
#include "firmware/exchange/latest_value.h"
#include "firmware/exchange/ring.h"
#include "mpc_core/control/plan.h"

namespace stilt::controller {

/// What goes from one thread to another. Housekeeping is every ordinary thread's work: operator, telemetry,
/// files.
struct Mailboxes {
  exchange::LatestValue<OperatorCommand> commands;          ///< operator -> torque loop
  exchange::LatestValue<TorqueTuning> torque_tunings;       ///< operator -> torque loop
  exchange::LatestValue<PlannerTuning> planner_tunings;     ///< operator -> planner
  exchange::LatestValue<PlanningRequest> requests;          ///< torque loop -> planner
  exchange::LatestValue<control::Plan> plans;               ///< planner -> torque loop
  exchange::LatestValue<PlanningResult> results;            ///< planner -> torque loop
  EventRing events;                                         ///< torque loop -> housekeeping
  exchange::Ring<diagnostics::TickRecord, 2048> telemetry;  ///< torque loop -> housekeeping, two seconds
  exchange::Ring<CycleRecord, 1024> cycles;                 ///< planner -> housekeeping
  exchange::LatestValue<PlanSketch> sketches;               ///< planner -> housekeeping
  diagnostics::TickBlackBox black_box;                      ///< torque loop; housekeeping once it is frozen
};

}  // namespace stilt::controller
