# toolchain/demo --headless as it is, on a kernel with CAN: it makes its own vcan interfaces. The machine has the
# programs already; its walk is cut short, because an emulated processor takes minutes for it.
demo=/tmp/stilt
mkdir -p $demo/toolchain $demo/build/joined/bin
cp /job/demo $demo/toolchain/
cp /job/stilt $demo/build/joined/bin/
: >$demo/toolchain/setup
printf '#!/bin/sh\n' >/bin/cmake
cat >$demo/build/joined/bin/stiltd <<'PROGRAM'
#!/bin/sh
exec /job/stiltd $(echo "$@" | sed 's/--duration [0-9]*/--duration 7/')
PROGRAM
chmod +x /bin/cmake $demo/toolchain/setup $demo/build/joined/bin/stiltd

failed=0
fail() {
  echo "FAILED: $*"
  failed=1
}
cd $demo
bash toolchain/demo --headless >demo.log 2>&1 || fail "it ended with status $?"
cat demo.log
cd build/demo
grep -q 'buses vcan_left and vcan_right' $demo/demo.log || fail "it did not choose the kernel's CAN"
grep -q '"fall_time_s": null' walk.json || fail "the robot fell"
grep -q '"sat_down_s": [0-9]' walk.json || fail "the robot did not sit down"
tr -d ' \n' <controller.json | grep -q '"faults":\[\]' || fail "faults: $(tr -d ' \n' <controller.json)"
[ -s walk.html ] || fail "no report"
[ -s walk.mcap ] || fail "no record"
exit $failed
