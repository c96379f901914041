# A fresh Debian gets the packages, and docs/first-day.md leads from unknown wiring to walking over the kernel's CAN.
# The page installs them so; without a network their dependencies are in the image, and dpkg is enough.
grep -qF 'apt install ./stiltd_*.deb' /job/first-day.md || {
  echo "docs/first-day.md does not install stiltd"
  exit 1
}
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
