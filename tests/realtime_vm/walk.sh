# stiltd walks the simulated robot over the kernel's CAN, both taking turns, on the real-time kernel. What may happen to
# the walk: walk_faults.sh.
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
exit $failed
