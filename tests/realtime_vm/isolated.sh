# stiltd on a kernel with isolcpus=1, as docs/deployment.md advises: no program inherits processor 1, and it is real time.
# No robot answers there, so that the run ends with a fault.
[ "$(cat /sys/devices/system/cpu/isolated)" = 1 ] || { echo "processor 1 is not isolated"; exit 1; }
stiltd --bus vcan0 --bus vcan1 --set runtime.torque_core=1 --set runtime.require_realtime_always=true \
  --set telemetry.enabled=false --duration 1 --json stiltd.json >stiltd.log 2>&1
cat stiltd.log
grep -q 'processor 1 isolated' stiltd.log && grep -q '"realtime": true' stiltd.json
