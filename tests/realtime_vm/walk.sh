# stiltd walks the simulated robot over the kernel's CAN, both taking turns, on the real-time kernel. In a second run
# stiltd is killed while it stands: the drivers let go, and a restart comes up idle. A third has a bus go off, and the
# robot killed at last.
. /job/lockstep.sh

echo "walking over vcan0 and vcan1"
start_robot
start_controller --start walk@0.5 --duration 2.5
expect_status stiltd $controller 0
kill -TERM $robot
wait $robot
tail -n 3 robot.log
expect_no_fault
grep -q '"heap_allocations": 0' stiltd.json || fail "the controller allocated memory"
grep -q '"fall_time_s": null' robot.json || fail "the robot fell"
steps=$(tr -d '\n' <robot.json | sed 's/.*"steps": \[\([^]]*\)\].*/\1/' | grep -o '"foot"' | wc -l)
[ "$steps" -ge 3 ] || fail "only $steps steps"

echo "stiltd is killed while it stands; another comes up idle"
start_robot
start_controller --start stand
wait_for_controller ' stand$'
sleep 3
kill -KILL $controller
expect_status stiltd $controller 137
start_controller --duration 0.5
expect_status "the second stiltd" $controller 0
cat stiltd.log
grep -q '"last_state": "idle"' stiltd.json || fail "it did not come up idle"
expect_no_fault
end_robot

echo "a bus goes off while standing, the controller damps; then the robot is killed"
start_robot --fault bus-off:0@0.2
start_controller --start stand
wait_for_controller 'fault bus_off'
sleep 1
kill -KILL $robot
expect_status stiltd $controller 1
cat stiltd.log
expect_fault bus_off:damp
grep -q 'the simulated robot stopped answering' stiltd.log || fail "stiltd did not say that the robot is gone"
exit $failed
