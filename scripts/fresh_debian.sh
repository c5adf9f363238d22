#!/usr/bin/env bash
# Installs softkin's Python package on a new Debian 12, made with debootstrap in a folder: the last commit from a
# clone, with only Python and a compiler; and a wheel, without a compiler. It runs the first script of docs/python.md
# in both. It needs root, debootstrap, and this machine's settings of apt and pip, which it copies to the new system.
#   scripts/fresh_debian.sh FOLDER [WHEEL...]   FOLDER: some GiB, kept; WHEEL: for Python 3.11, from scripts/wheels.sh
# Exit codes: 0 everything runs, 1 a step failed, 2 usage.
set -euo pipefail

[ $# -ge 1 ] && [ "$(id -u)" -eq 0 ] && command -v debootstrap >/dev/null || {
  sed -n '2,6s/^# //p' "$0" >&2
  exit 2
}
name=fresh_debian
folder=$(realpath -m "$1")
shift
source=$(realpath "$(dirname "$0")/..")
. "$source/scripts/fresh_root.sh"

first_script="cd /softkin/examples/python && /softkin/venv/bin/python first_bend.py && /softkin/venv/bin/softkin --version"

fresh clone ,g++,make
git clone --quiet "$source" "$folder/clone/softkin"
echo "fresh_debian: a clone, with Python and a compiler"
inside clone "cd /softkin && make python && ln -s build-python venv && $first_script"

if [ $# -gt 0 ]; then
  fresh wheel ""
  mkdir -p "$folder/wheel/softkin"
  cp "$@" "$folder/wheel/softkin/"
  cp -r "$source/examples" "$folder/wheel/softkin/"
  echo "fresh_debian: a wheel, without a compiler"
  inside wheel "! command -v c++ gcc && cd /softkin && python3 -m venv venv && venv/bin/pip install --quiet *.whl && $first_script"
fi
echo "fresh_debian: all of it runs"
