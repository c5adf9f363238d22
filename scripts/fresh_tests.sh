#!/usr/bin/env bash
# Runs `make test` in a clone on a new Debian 12, made with debootstrap in a folder: on one without Python packages,
# and on one with numpy, scipy, meshio and matplotlib. Both must pass; a skipped test counts as a failure, except for
# tests of data that are not in the repository. It needs root, debootstrap, and this machine's settings of apt and pip,
# which it copies to the new systems. If CCACHE_DIR is set, the systems use this cache.
#   scripts/fresh_tests.sh FOLDER [bare | packages]   FOLDER: some 10 GiB, kept; which of the two systems (default: both)
# Exit codes: 0 all tests pass, 1 a test or step failed, 2 usage.
set -euo pipefail

[[ $# -ge 1 && $# -le 2 && ${2:-bare} =~ ^(bare|packages)$ && $(id -u) -eq 0 ]] && command -v debootstrap >/dev/null || {
  sed -n '2,7s/^# //p' "$0" >&2
  exit 2
}
name=fresh_tests
folder=$(realpath -m "$1")
source=$(realpath "$(dirname "$0")/..")
. "$source/scripts/fresh_root.sh"
cache=${CCACHE_DIR:-}

# test_on SYSTEM PACKAGES: tests a clone with the path of this one, so that the compiler cache applies
test_on() {
  fresh "$1" ",git,make${cache:+,ccache}$2"
  git clone --quiet "$source" "$folder/$1$source"
  echo "fresh_tests: make test, $1; all that it prints: $folder/$1-test.log"
  inside "$1" "cd '$source' && SOFTKIN_NO_SKIP=1 make test" 2>&1 | tee "$folder/$1-test.log" |
    awk '/^setup: |tests passed|tests failed|\(Failed\)| passed in | failed|passed, / || listed; /^skipped tests: / { print; listed = 1 }'
}

[ "${2:-bare}" = packages ] || test_on bare ""
[ "${2:-packages}" = bare ] || test_on packages ",python3-numpy,python3-scipy,python3-meshio,python3-matplotlib"
echo "fresh_tests: all of it passes"
