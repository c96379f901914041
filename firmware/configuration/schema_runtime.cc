#include "firmware/configuration/schema_fields.h"
#include "firmware/configuration/schema_tables.h"

namespace stilt::configuration {
namespace {

using namespace fields;
using P = Parameters;
using R = RuntimeParameters;

constexpr std::string_view kReferences[] = {"heuristic", "hzd"};
static_assert(static_cast<int>(ReferenceKind::hzd) == 1);

constexpr Section kSections[] = {
    {"controller", "Which controller stiltd runs; stilt sim takes --controller."},
    {"runtime", "How stiltd runs on its computer."},
};

constexpr Entry kEntries[] = {
    {"controller", "reference", "",
     "What the planner's cost pulls to; hzd: shipped gaits with their step time. Their double support,\n"
     "terminal cost and weights of feet hold unless --set says otherwise",
     choice<&P::controller, &ControllerChoice::reference>(kReferences)},
    {"runtime", "require_realtime", "",
     "Refuse to start on a CAN interface unless kernel, priorities and locked memory make the torque loop "
     "real time",
     flag<&P::runtime, &R::require_realtime>()},
    {"runtime", "require_realtime_always", "", "The same with buses that are all loopback:NAME or vcan",
     flag<&P::runtime, &R::require_realtime_always>()},
    {"runtime", "torque_core", "1", "Processor of the torque loop; -1 leaves it to the kernel",
     integer<&P::runtime, &R::torque_core>(-1, 1023)},
    {"runtime", "planner_core", "1", "Processor of the planner; -1 leaves it to the kernel",
     integer<&P::runtime, &R::planner_core>(-1, 1023)},
    {"runtime", "torque_priority", "1", "SCHED_FIFO priority of the torque loop; 0: ordinary scheduling",
     integer<&P::runtime, &R::torque_priority>(0, 99)},
    {"runtime", "planner_priority", "1",
     "SCHED_FIFO priority of the planner, at least 2 below the torque loop's; 0: ordinary scheduling",
     integer<&P::runtime, &R::planner_priority>(0, 98)},
    {"runtime", "idle_exit_max_s", "s",
     "Longest time that an idle processor may take to wake, held through /dev/cpu_dma_latency while stiltd "
     "runs in real time",
     real<&P::runtime, &R::idle_exit_max_s>(0.0, 0.01)},
    {"runtime", "self_test_answered_share", "1",
     "stiltd selftest: share of the commands on the bus that each driver must answer, in time or late",
     real<&P::runtime, &R::self_test_answered_share>(0.0, 1.0)},
    {"runtime", "self_test_in_time_share", "1",
     "stiltd selftest: share of the commands that must be answered before the next one",
     real<&P::runtime, &R::self_test_in_time_share>(0.0, 1.0)},
    {"runtime", "self_test_late_share", "1",
     "stiltd selftest: share of the ticks that may begin later than supervisor.torque_loop_overrun_s, with "
     "the planner at work",
     real<&P::runtime, &R::self_test_late_share>(0.0, 1.0)},
    {"runtime", "start_settle_s", "s", "stiltd --start: stands this long before the first step",
     real<&P::runtime, &R::start_settle_s>(0.0, 60.0)},
};

}  // namespace

std::span<const Section> runtime_sections() { return kSections; }

std::span<const Entry> runtime_entries() { return kEntries; }

}  // namespace stilt::configuration
