# What may happen to a walk over the kernel's CAN, on the real-time kernel, both taking turns. It is error frames, a bus
# that goes off, a queue that is full, stiltd killed, the robot killed.
. /job/lockstep.sh

echo "error frames while walking: reported, and it walks on; then a bus goes off: damped"
start_robot
start_walk
send_error_frame vcan0 warning
send_error_frame vcan1 passive
wait_for_ticks 300
grep -q ' fault$' stiltd.log && fail "error frames ended the walk"
send_error_frame vcan1 bus-off
wait_for_controller ' fault$'
wait_for_ticks 200
kill -TERM $controller
expect_status stiltd $controller 1
faults
expect_fault bus_error:warn
expect_fault bus_off:damp
grep -q '"last_state": "fault"' stiltd.json || fail "the fault does not last"
end_robot

echo "a queue is full while walking: the commands to a leg are dropped, the robot is damped"
start_robot
start_walk
# Identifiers 0 to 3, the commands; a frame of CAN begins with its identifier, the lowest byte first.
tc qdisc add dev vcan0 root handle 1: prio bands 2 priomap 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0
tc qdisc add dev vcan0 parent 1:2 handle 20: netem delay 200s limit 4
tc filter add dev vcan0 parent 1: protocol all prio 1 u32 match u32 0 0xfcffffff at 0 flowid 1:2
wait_for_controller ' fault$'
wait_for_ticks 200
tc -s qdisc show dev vcan0
tc qdisc del dev vcan0 root
kill -TERM $controller
expect_status stiltd $controller 1
faults
expect_fault bus_error:warn
expect_fault missed_replies:hold
expect_fault lost_replies:damp
end_robot

echo "stiltd is killed while it walks: the drivers disable themselves, and another comes up idle"
start_robot
start_walk
kill -KILL $controller
expect_status stiltd $controller 137
start_controller --duration 1
expect_status "the second stiltd" $controller 0
expect_no_fault
grep -q '"last_state": "idle"' stiltd.json || fail "it did not come up idle"
end_robot
grep -q '"survived": false' robot.json || fail "a robot without torque cannot have stood on"

echo "the robot is killed while it walks: no replies, damped"
start_robot
start_walk
kill -KILL $robot
expect_status stiltd $controller 1
grep -v '^bus' stiltd.log
expect_fault missed_replies:hold
expect_fault lost_replies:damp
grep -q '"last_state": "fault"' stiltd.json || fail "the fault does not last"
grep -q 'the simulated robot stopped answering' stiltd.log || fail "stiltd did not report that the robot is gone"
exit $failed
