# Robot and controller on both ends of two wires. Each end is a CAN controller (SJA1000 on a Kvaser board, emulated)
# with the kernel's driver: its queue, its mailbox, its echoes. These controllers have no CAN FD, and their wires
# no bit errors.
robot_left=can1 robot_right=can3 controller_left=can0 controller_right=can2 frames_per_tick=3
. /job/lockstep.sh

wire_up() {
  ip link set "$1" up type can bitrate 1000000 || fail "$1 does not come up"
  ip link set "$1" txqueuelen 100
}
for bus in can0 can1 can2 can3; do wire_up $bus; done

echo "interrupt threads come before the planner"
for bus in can0 can2; do
  stiltd interrupts $bus | grep -q "^$bus: irq/[0-9]*-$bus (process [0-9]*, priority 50) has 70 now$" ||
    fail "the thread of $bus is not raised: $(stiltd interrupts $bus 2>&1)"
  stiltd interrupts $bus | grep -q ', priority 70) stays$' || fail "the kernel did not take the priority of $bus"
done

echo "comes up and stands; then a bus goes down: damped"
start_robot
start_controller --start stand
wait_for_controller ' stand$'
wait_for_ticks 40
ip link set can0 down
expect_status stiltd $controller 1
cat stiltd.log
expect_fault bus_disconnected:damp
grep -q '"last_state": "fault"' stiltd.json || fail "the fault does not last"
kill -TERM $robot
wait $robot

echo "the bus is back: comes up and stands again"
wire_up can0
start_robot
start_controller --start stand
wait_for_controller ' stand$'
wait_for_ticks 40
kill -0 $controller || fail "stiltd has ended"
! grep -q ' fault$' stiltd.log || fail "a fault: $(cat stiltd.log)"
kill -KILL $controller
kill -TERM $robot
wait $robot
for bus in can0 can2; do
  [ "$(cat /sys/class/net/$bus/statistics/tx_packets)" -ge 150 ] || fail "few frames on $bus"
done
exit $failed
