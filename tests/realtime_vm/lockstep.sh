# For scripts in the virtual machine. Robot and controller take turns on vcan0 and vcan1, or on the interfaces that the
# script names before it reads this file.
: "${robot_left:=vcan0}" "${robot_right:=vcan1}" "${controller_left:=vcan0}" "${controller_right:=vcan1}"
# That robot_right sends: two commands, two replies, two syncs; of an interface of its own the robot's half.
: "${frames_per_tick:=6}"
quick="--set runtime.start_settle_s=1.2 --set supervisor.stand_ramp_s=0.4 --set supervisor.slow_down_s=0.8 \
  --set supervisor.damped_before_off_s=0.5"
failed=0

fail() {
  echo "FAILED: $*"
  failed=1
}

# Starts the robot with the options given, and waits until it listens on the last bus it opens.
start_robot() {
  rm -f robot.json
  stilt robot --bus $robot_left --bus $robot_right --lockstep --json robot.json "$@" >robot.log 2>&1 &
  robot=$!
  until grep -qs "^ *$robot_right " /proc/net/can/rcvlist_*; do
    kill -0 $robot 2>/dev/null || {
      cat robot.log
      fail "the robot ended before it began"
      return
    }
    sleep 0.2
  done
}

# start_controller OPTIONS: in the background; its output goes to stiltd.log.
start_controller() {
  rm -f stiltd.json stiltd.log
  stiltd --bus $controller_left --bus $controller_right $quick --lockstep --json stiltd.json "$@" >stiltd.log 2>&1 &
  controller=$!
}

# wait_for_controller TEXT: until it prints the text, or ends.
wait_for_controller() {
  until grep -qs "$1" stiltd.log; do
    kill -0 $controller 2>/dev/null || {
      fail "stiltd ended before it printed '$1': $(cat stiltd.log)"
      return
    }
    sleep 0.2
  done
}

# wait_for_ticks COUNT: of lock-step.
wait_for_ticks() {
  local sent=/sys/class/net/$robot_right/statistics/tx_packets
  local enough=$(($(cat $sent) + frames_per_tick * $1))
  while [ "$(cat $sent)" -lt $enough ] && kill -0 $controller 2>/dev/null; do sleep 0.2; done
}

# The controller, walking for a second.
start_walk() {
  start_controller --start walk@0.5
  wait_for_controller ' walk$'
  wait_for_ticks 1000
}

# expect_status NAME PROCESS STATUS: it ends so.
expect_status() {
  local status=0
  wait "$2" || status=$?
  [ $status -eq "$3" ] || fail "$1 ended with status $status, not $3"
}

# The faults that stiltd reports, name:reaction, in their order.
faults() {
  tr -d ' \n' <stiltd.json | sed 's/.*"faults":\[\([^]]*\)\].*/\1/' |
    sed 's/},{/}\n{/g' | sed -n 's/.*"name":"\([^"]*\)".*"reaction":"\([^"]*\)".*/\1:\2/p'
  echo
}

# expect_fault NAME:REACTION
expect_fault() {
  faults | grep -qx "$1" || fail "no $1 among the faults: $(faults | tr '\n' ' ')"
}

expect_no_fault() {
  [ -z "$(faults)" ] || fail "faults: $(faults | tr '\n' ' ')"
}

# Ends the robot; afterwards no driver may be enabled.
end_robot() {
  kill -TERM $robot
  wait $robot
  grep -q '"enabled": false' robot.json || fail "robot.json contains nothing of its drivers"
  ! grep -q '"enabled": true' robot.json || fail "a driver is still enabled"
}
