#!/usr/bin/env bash
# Runs `make test` in a clone on a fresh Debian 12, made with debootstrap in a folder: on one without Python packages, and on
# one whose system has numpy, scipy, meshio and matplotlib for its own Python. Both must pass, and a test that is skipped
# fails, but for those of data that are not in the repository. Needs root, debootstrap, and this machine's settings of apt
# and pip, which the fresh ones get too. CCACHE_DIR, if it is set, is shared with them.
#   scripts/fresh_tests.sh FOLDER [bare | packages]   FOLDER: some 10 GiB, kept; which of the two systems (default: both)
# Exit codes: 0 all of it passes, 1 something does not, 2 usage.
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

# test_on SYSTEM PACKAGES: the clone lies where this one does, so that what compilers make can come from a cache
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
