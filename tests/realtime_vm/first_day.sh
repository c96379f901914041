# A fresh Debian gets the packages, and docs/first-day.md leads from unknown wiring to walking over the kernel's CAN.
dpkg -i /job/*.deb >dpkg.log 2>&1 || {
  cat dpkg.log
  exit 1
}
# The test has page and programs at the paths of its build.
. /job/first_day_paths
mkdir -p "$(dirname "$page")" "$(dirname "$stilt")" "$(dirname "$stiltd")"
cp /job/first-day.md "$page"
ln -s "$(command -v stilt)" "$stilt"
ln -s "$(command -v stiltd)" "$stiltd"
STILT_TEST_VCAN=1 exec /job/two_processes_first_day_test
