#pragma once

namespace stilt::configuration {

/// How the program runs on its computer.
struct RuntimeParameters {
  /// Refuse to start on a CAN interface unless kernel, priorities and locked memory make the torque loop real
  /// time. On loopback and vcan buses, which carry no motor's frames, with require_realtime_always alone.
  bool require_realtime = true;
  bool require_realtime_always = false;
  int torque_core = 1;                      ///< processor of the torque loop; -1: wherever the kernel puts it
  int planner_core = 0;                     ///< processor of the planner; -1 as above
  int torque_priority = 80;                 ///< SCHED_FIFO, 1 to 99; 0: ordinary scheduling
  int planner_priority = 60;                ///< as above, at least 2 below torque_priority
  double idle_exit_max_s = 1e-5;            ///< held through /dev/cpu_dma_latency; whole microseconds
  double self_test_answered_share = 0.999;  ///< of the commands of stiltd selftest, in time or late
  double self_test_in_time_share = 0.99;    ///< of the commands, before the next one
  double self_test_late_share = 0.001;      ///< of the ticks, later than supervisor.torque_loop_overrun_s
  double start_settle_s = 2.0;              ///< stiltd --start: stands this long before it steps
};

}  // namespace stilt::configuration
