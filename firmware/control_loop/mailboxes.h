#pragma once

#include "firmware/control_loop/cycle_record.h"
#include "firmware/control_loop/events.h"
#include "firmware/control_loop/messages.h"
#include "firmware/control_loop/tick_record.h"
#include "firmware/exchange/latest_value.h"
#include "hal/exchange/ring.h"
#include "mpc_core/control/plan.h"

namespace stilt::control_loop {

/// What goes from one thread to another. Housekeeping is every ordinary thread's work: operator, telemetry,
/// files.
struct Mailboxes {
  exchange::LatestValue<OperatorCommand> commands;           ///< operator -> torque loop
  StopSignals stops;                                         ///< signal handlers -> torque loop
  exchange::LatestValue<TorqueTuning> torque_tunings;        ///< operator -> torque loop
  exchange::LatestValue<PlannerTuning> planner_tunings;      ///< operator -> planner
  exchange::LatestValue<PlanningRequest> requests;           ///< torque loop -> planner
  exchange::LatestValue<control::Plan> plans;                ///< planner -> torque loop
  exchange::LatestValue<PlanningResult> results;             ///< planner -> torque loop
  EventRing events;                                          ///< torque loop -> housekeeping
  exchange::Ring<control_loop::TickRecord, 2048> telemetry;  ///< torque loop -> housekeeping, two seconds
  exchange::Ring<CycleRecord, 1024> cycles;                  ///< planner -> housekeeping
  exchange::LatestValue<PlanPreview> previews;               ///< planner -> housekeeping
  control_loop::TickBlackBox black_box;                      ///< torque loop; housekeeping once it is frozen
};

}  // namespace stilt::control_loop
