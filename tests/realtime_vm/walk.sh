# stiltd walks the simulated robot over the kernel's CAN, both taking turns, on the real-time kernel. In a second run
# stiltd is killed while it stands: the drivers let go, and a restart comes up idle. A third has a bus go off, and the
# robot killed at last.
quick="--set runtime.start_settle_s=1.2 --set supervisor.stand_ramp_s=0.4 --set supervisor.slow_down_s=0.8"
failed=0

fail() {
  echo "FAILED: $*"
  failed=1
}

# Starts the robot with the options given, and waits until it listens on the last bus it opens.
start_robot() {
  rm -f robot.json
  stilt robot --bus vcan0 --bus vcan1 --lockstep --json robot.json "$@" >robot.log 2>&1 &
  robot=$!
  until grep -qs '^ *vcan1 ' /proc/net/can/rcvlist_*; do
    kill -0 $robot 2>/dev/null || {
      cat robot.log
      fail "the robot ended before it began"
      return
    }
    sleep 0.2
  done
}

echo "walking over vcan0 and vcan1"
start_robot
stiltd --bus vcan0 --bus vcan1 --start walk@0.5 --duration 2.5 $quick --lockstep --json stiltd.json ||
  fail "stiltd ended with status $?"
kill -TERM $robot
wait $robot
tail -n 3 robot.log
tr -d ' \n' <stiltd.json | grep -q '"faults":\[\]' || fail "faults: $(tr -d ' \n' <stiltd.json)"
grep -q '"heap_allocations": 0' stiltd.json || fail "the controller allocated memory"
grep -q '"fall_time_s": null' robot.json || fail "the robot fell"
steps=$(tr -d '\n' <robot.json | sed 's/.*"steps": \[\([^]]*\)\].*/\1/' | grep -o '"foot"' | wc -l)
[ "$steps" -ge 3 ] || fail "only $steps steps"

echo "stiltd is killed while it stands; another comes up idle"
start_robot
stiltd --bus vcan0 --bus vcan1 --start stand $quick --lockstep >stiltd.log 2>&1 &
controller=$!
until grep -qs ' stand$' stiltd.log; do
  kill -0 $controller 2>/dev/null || break
  sleep 0.2
done
sleep 3
kill -KILL $controller
wait $controller
[ $? -eq 137 ] || fail "stiltd was not there to be killed"
stiltd --bus vcan0 --bus vcan1 --duration 0.5 --lockstep --json stiltd.json >stiltd.log 2>&1 ||
  fail "the second stiltd ended with status $?"
cat stiltd.log
grep -q '"last_state": "idle"' stiltd.json || fail "it did not come up idle"
tr -d ' \n' <stiltd.json | grep -q '"faults":\[\]' || fail "faults: $(tr -d ' \n' <stiltd.json)"
kill -TERM $robot
wait $robot
grep -q '"enabled": true' robot.json && fail "a driver is still enabled"

echo "a bus goes off while standing, the controller damps; then the robot is killed"
start_robot --fault bus-off:0@0.2
stiltd --bus vcan0 --bus vcan1 --start stand $quick --lockstep --json stiltd.json >stiltd.log 2>&1 &
controller=$!
until grep -qs 'fault bus_off' stiltd.log; do
  kill -0 $controller 2>/dev/null || break
  sleep 0.2
done
sleep 1
kill -KILL $robot
wait $controller
status=$?
cat stiltd.log
grep -q '"name": "bus_off"' stiltd.json || fail "bus_off is not among the faults"
grep -q '"reaction": "damp"' stiltd.json || fail "it did not damp"
[ $status -eq 1 ] || fail "stiltd ended with status $status, not 1"
grep -q 'the simulated robot stopped answering' stiltd.log || fail "stiltd did not say that the robot is gone"
exit $failed
