#!/usr/bin/env bash
# Tests the page of apps/view/web: its types, its units, and in headless Chromium the pages of a program; or its live mode.
#   scripts/test_page.sh PROGRAM FOLDER [live]   FOLDER: what npm installs, and screenshots, to be looked at
# Exit codes: 0 all of it passes, or there is no page to test, which is said; 1 something fails, 2 usage.
set -euo pipefail

part=${3:-files}
[[ $# -ge 2 && $# -le 3 && $part =~ ^(files|live)$ ]] || { sed -n '2,4s/^# //p' "$0" >&2; exit 2; }
program=$(realpath "$1")
mkdir -p "$2"
folder=$(realpath "$2")
source=$(realpath "$(dirname "$0")/..")
if ! "$program" view --help >/dev/null 2>&1 || ! command -v npm >/dev/null; then
  echo "test_page: skipped: no npm"
  exit 0
fi
if ! grep -q 'id="softkin-page"' "$program"; then
  echo "test_page: skipped: $program was built without its page"
  exit 0
fi

# taken NAME FROM: a copy, beside what npm installed there before
taken() {
  mkdir -p "$folder/$1"
  find "$folder/$1" -mindepth 1 -maxdepth 1 ! -name node_modules -exec rm -rf {} +
  (cd "$2" && tar -c --exclude=node_modules --exclude=dist .) | tar -x -C "$folder/$1"
  (cd "$folder/$1" && npm ci --no-audit --no-fund --loglevel=error)
}

if [ "$part" = files ]; then
  taken web "$source/apps/view/web"
  (cd "$folder/web" && npm run --silent check && npm test --silent)
fi
taken browser "$source/tests/browser"
cd "$folder/browser"
SOFTKIN_SOURCE=$source node run.mjs "$program" "$folder/screenshots" "$part"
