# The packages on a fresh Debian with systemd: the service as it is shipped comes up and ends. The robot walks, and sits
# down when the service is stopped. The service is stopped before its package is removed. Walks are in lock-step: durations in the machine mean nothing.
. /job/lockstep.sh

# expect NAME FOUND WANTED
expect() {
  [ "$2" = "$3" ] || fail "$1 is '$2', not '$3'"
}

said() {
  journalctl -u stiltd -o cat --no-pager
}

echo "installing"
dpkg -i /job/*.deb >dpkg.log 2>&1 || fail "the packages do not install: $(cat dpkg.log)"
expect "the service after the installation" "$(systemctl is-active stiltd)" inactive
exposure=$(systemd-analyze security --no-pager stiltd.service |
  sed -n 's/.*exposure level for stiltd.service: \([0-9.]*\).*/\1/p')
echo "exposure $exposure"
[ "$(echo "$exposure" | tr -d .)" -le 30 ] || fail "the exposure is '$exposure', above 3.0"
echo "bringing a bus up"
# Of the interrupt thread of can0.
priority() {
  chrt -p "$(pgrep -x 'irq/[0-9]+-can0')" | sed -n 's/.*priority: //p'
}
systemctl enable --now can@can0 >can.log 2>&1 || fail "can@can0 does not start: $(cat can.log)"
ip -details link show can0 | grep -q 'bitrate 1000000' || fail "can0 has another bit rate"
ip link show can0 | grep -q 'UP.* qlen 100' || fail "can0 is down, or its queue is short: $(ip link show can0)"
expect "the priority of its interrupt thread" "$(priority)" 70
systemctl restart can@can0
expect "the priority after a restart of the bus" "$(priority)" 70
systemctl disable --now can@can0 >can.log 2>&1
! ip link show can0 | grep -q 'UP' || fail "can0 is up without its unit"

sed -i 's/^buses = .*/buses = "vcan0,vcan1"/' /etc/stilt/stiltd.toml
mkdir -p /etc/systemd/system/stiltd.service.d
printf '[Service]\nWatchdogSec=1200\nTimeoutStartSec=1200\nTimeoutStopSec=1200\n' \
  >/etc/systemd/system/stiltd.service.d/slow_machine.conf
systemctl daemon-reload

echo "starting the service"
stilt robot --bus vcan0 --bus vcan1 >robot.log 2>&1 &
robot=$!
systemctl start stiltd || fail "the service does not start: $(said)"
expect "the service" "$(systemctl is-active stiltd)" active
expect "the user of stiltd" "$(ps -o user= -C stiltd)" stilt
expect "the token" "$(stat -c '%U %a' /run/stilt/stilt/token*[0-9])" "stilt 600"
expect "the group of cpu_dma_latency" "$(stat -c %G /dev/cpu_dma_latency)" stilt
ls -l "/proc/$(pidof stiltd)/fd" | grep -q cpu_dma_latency || fail "the processors may sleep"
systemctl stop stiltd
expect "the result of the service" "$(systemctl show -p Result --value stiltd)" success
grep -q '"last_state"' /var/lib/stilt/last_run.json || fail "no results of the run"
kill -TERM $robot
wait $robot

# Robot and service, walking for a second.
walk() {
  start_robot
  systemctl start stiltd
  controller=$(pidof stiltd) || fail "the service does not start: $(said)"
  until said | grep -q ' walk$'; do
    kill -0 "$controller" 2>/dev/null || {
      fail "the service ended before it walked: $(said)"
      return
    }
    sleep 5
  done
  wait_for_ticks 1000
}

# expect_seat WHEN: the robot sat down in order, and no driver is enabled.
expect_seat() {
  ! pidof stiltd || fail "stiltd runs on $1"
  end_robot
  grep -q '"sat_down_s": [0-9]' robot.json || fail "the robot did not sit down $1: $(tail -n 3 robot.log)"
}

# Lock-step has no readiness.
unit=$(systemctl show -p FragmentPath --value stiltd)
cat >/etc/systemd/system/stiltd.service.d/lockstep.conf <<UNIT
[Service]
Type=exec
ExecStart=
$(sed -n '/^ExecStart=/,/[^\\]$/p' "$unit") $quick --lockstep --start walk@0.5
UNIT
systemctl daemon-reload

echo "stopping a robot that walks"
walk
systemctl stop stiltd
expect "the result of the service" "$(systemctl show -p Result --value stiltd)" success
expect_seat "when the service was stopped"
cp /var/lib/stilt/last_run.json stiltd.json
expect_no_fault

echo "removing the package of a robot that walks"
journalctl --rotate --vacuum-time=1s >vacuum.log 2>&1
walk
dpkg -r stiltd >dpkg.log 2>&1 || fail "the package is not removed: $(cat dpkg.log)"
expect_seat "when the package was removed"
[ -e /etc/stilt/stiltd.toml ] || fail "the configuration went with the package"
dpkg -P stiltd >dpkg.log 2>&1 || fail "the package is not purged: $(cat dpkg.log)"
if [ -e /var/lib/stilt ] || getent passwd stilt; then fail "a purge leaves folder or user"; fi
exit $failed
