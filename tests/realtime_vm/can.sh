# Everything that needs the kernel's CAN. A test that skips here has not run anywhere.
[ "$(cat /sys/kernel/realtime)" = 1 ] || { echo "this is no real-time kernel"; exit 1; }
hal_test --gtest_filter='VirtualCan.*' >hal.log 2>&1
status=$?
cat hal.log
virtual_can_test || status=1
slcan_test || status=1
if grep -q SKIPPED hal.log; then
  echo "tests were skipped"
  status=1
fi
exit $status
