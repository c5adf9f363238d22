#!/usr/bin/env bash
# Installs softkin's Python package on a fresh Debian 12, made with debootstrap in a folder: what is committed, from a
# clone, with Python and a compiler alone; and a wheel, without a compiler. The first script of docs/python.md runs in
# both. Needs root, debootstrap, and this machine's settings of apt and pip, which the fresh one gets too.
#   scripts/fresh_debian.sh FOLDER [WHEEL...]   FOLDER: some GiB, kept; WHEEL: of Python 3.11, made by scripts/wheels.sh
# Exit codes: 0 all of it runs, 1 something does not, 2 usage.
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
