#!/usr/bin/env bash
# Tests the page of apps/view/web: its types, its units, and in headless Chromium the pages of a program; or its live mode.
#   scripts/test_page.sh PROGRAM FOLDER [live]   FOLDER: packages of npm, and screenshots for inspection
# Exit codes: 0 all tests pass, or there is no page to test, which the script reports and appends to the file
# SOFTKIN_SKIPPED; 1 a test fails, or is skipped while SOFTKIN_NO_SKIP is set; 2 usage.
set -euo pipefail

part=${3:-files}
[[ $# -ge 2 && $# -le 3 && $part =~ ^(files|live)$ ]] || { sed -n '2,5s/^# //p' "$0" >&2; exit 2; }
program=$(realpath "$1")
mkdir -p "$2"
folder=$(realpath "$2")
source=$(realpath "$(dirname "$0")/..")

skip() { # REASON
  echo "test_page: skipped: $1"
  [ -z "${SOFTKIN_SKIPPED:-}" ] || echo "test_page.sh $part: $1" >>"$SOFTKIN_SKIPPED"
  [ -z "${SOFTKIN_NO_SKIP:-}" ] || exit 1
  exit 0
}

command -v npm >/dev/null || skip "the program npm is not installed"
grep -q 'id="softkin-page"' "$program" || skip "built without the page"

# copy_sources NAME FROM: copies a folder without removing its installed packages, and installs these
copy_sources() {
  mkdir -p "$folder/$1"
  find "$folder/$1" -mindepth 1 -maxdepth 1 ! -name node_modules -exec rm -rf {} +
  (cd "$2" && tar -c --exclude=node_modules --exclude=dist .) | tar -x -C "$folder/$1"
  (cd "$folder/$1" && npm ci --no-audit --no-fund --loglevel=error)
}

if [ "$part" = files ]; then
  copy_sources web "$source/apps/view/web"
  (cd "$folder/web" && npm run --silent check && npm test --silent)
fi
copy_sources browser "$source/tests/browser"
cd "$folder/browser"
SOFTKIN_SOURCE=$source node run.mjs "$program" "$folder/screenshots" "$part"
