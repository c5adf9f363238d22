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
folder=$(realpath -m "$1")
shift
source=$(realpath "$(dirname "$0")/..")
mirror=$(apt-get indextargets --format '$(SITE)' 'Created-By: Packages' | head -n 1)

# fresh NAME PACKAGES: a system of its own, from an archive of the packages that the first one leaves
fresh() {
  local root=$folder/$1
  [ ! -e "$root" ] || { echo "fresh_debian: $root is there already: remove it" >&2; exit 2; }
  mkdir -p "$folder/archives"
  debootstrap --variant=minbase --cache-dir="$folder/archives" --include="ca-certificates,python3,python3-venv$2" bookworm \
    "$root" "$mirror" >"$folder/$1.log" 2>&1 || { tail -n 5 "$folder/$1.log" >&2; exit 1; }
  rm "$root/etc/apt/sources.list"
  cp -a /etc/apt/. "$root/etc/apt/"
  cp -a /etc/ssl/certs/. "$root/etc/ssl/certs/"
  cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
  [ ! -f /etc/pip.conf ] || cp /etc/pip.conf "$root/etc/"
}

inside() { # NAME COMMAND: with the variables that pip and apt read, and /proc, by which programs find their libraries
  local root=$folder/$1
  shift
  local settings
  mapfile -t settings < <(env | grep -iE '^(pip_|https?_proxy|no_proxy)' || true)
  env -i "${settings[@]}" PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
    unshare --mount bash -euc 'mount -t proc proc "$0/proc" && exec chroot "$0" bash -euo pipefail -c "$1"' "$root" "$*"
}

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
