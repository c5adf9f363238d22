#!/usr/bin/env bash
# Installs the missing packages that softkin needs to build. --tests adds the packages of `make test`, --tests-deep
# also those of `make test-deep`; --python those of the Python package for PYTHON (default: python3); --arm those for
# building for aarch64 and running it here; --tidy those of `make tidy`. The Python packages of the tests go into the
# virtual environment build-tests/python.
# Exit codes: 0 all packages are installed, 2 a package is missing and could not be installed.
set -euo pipefail

packages=(clang g++ cmake ninja-build libeigen3-dev libyaml-cpp-dev nlohmann-json3-dev libpugixml-dev zlib1g-dev libpng-dev
          libcli11-dev libmetis-dev libnanoflann-dev libqhull-dev libboost-dev)
# for the page of softkin view and --html; any npm with Node.js 18 or later is sufficient
command -v npm >/dev/null || packages+=(npm)
python=${PYTHON:-python3}
requirements=()
case "${1:-}" in
  "") ;;
  --tests | --tests-deep)
    packages+=(libgtest-dev clang-format-14 libopencv-dev libclang-rt-dev lld mawk gawk original-awk)
    command -v "${SOFTKIN_CHROMIUM:-chromium}" >/dev/null || packages+=(chromium)
    "$python" -c 'import ensurepip, venv' 2>/dev/null || packages+=(python3-venv)
    requirements=(tests/requirements.txt)
    if [ "$1" = --tests-deep ]; then
      packages+=(libopenmpi-dev openmpi-bin calculix-ccx)
      command -v gmsh >/dev/null || packages+=(gmsh)
      requirements+=(tests/requirements-deep.txt)
    fi
    ;;
  --python)
    "$python" -c 'import ensurepip, venv' 2>/dev/null || packages+=(python3-venv)
    "$python" -c 'import os, sysconfig; os.stat(sysconfig.get_path("include") + "/Python.h")' 2>/dev/null || packages+=(python3-dev)
    ;;
  --arm) packages+=(g++-aarch64-linux-gnu qemu-user) ;;
  --tidy) packages+=(clang-tidy-14 libopencv-dev) ;;
  *) echo "usage: scripts/setup.sh [--tests | --tests-deep | --python | --arm | --tidy]" >&2; exit 2 ;;
esac

fail() {
  printf 'setup: %s\n' "$@" >&2
  exit 2
}

# Makes the virtual environment of the tests. `make test` skips and lists the tests whose packages it does not contain.
finish() {
  [ ${#requirements[@]} -gt 0 ] || exit 0
  local folder done_file wanted
  folder=$(dirname "$0")/../build-tests/python
  done_file=$folder/requirements.txt
  wanted=$(cd "$(dirname "$0")/.." && "$python" --version && cat "${requirements[@]}")
  [ "$(head -n "$(wc -l <<<"$wanted")" "$done_file" 2>/dev/null)" = "$wanted" ] && exit 0
  echo "setup: installs the packages of ${requirements[*]} into build-tests/python"
  if [ "$("$folder/bin/python" --version 2>/dev/null)" != "$("$python" --version)" ]; then
    "$python" -m venv --clear "$folder" || fail "$python cannot make a virtual environment in build-tests/python"
  fi
  if (cd "$(dirname "$0")/.." && build-tests/python/bin/pip install --quiet "${requirements[@]/#/--requirement=}"); then
    echo "$wanted" >"$done_file"
  else
    echo "setup: pip could not install them (above); tests that need them are skipped" >&2
  fi
  exit 0
}

system="this system"
if [ -r /etc/os-release ]; then
  system=$(. /etc/os-release && echo "${PRETTY_NAME:-${ID:-this system}}")
fi
if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  fail "$system has no apt; softkin is made for Debian 12 and Ubuntu 24.04." \
       "Install a C++20 compiler (clang 14, gcc 12 or later), CMake 3.22, Ninja, Eigen 3.4, yaml-cpp, nlohmann-json," \
       "pugixml, zlib, libpng, CLI11, METIS, nanoflann, Qhull and Boost 1.74, with their headers, and Node.js 18 with npm for the page;" \
       "for the tests also GoogleTest, clang-format 14, clang with libFuzzer, lld, Chromium, and Python with venv and pip, in" \
       "build-tests/python with the packages of tests/requirements.txt;" \
       "for softkin measure OpenCV 4.5 or 4.6." \
       "Then run make again with SETUP=true, e.g.: make run SETUP=true"
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)
  [ "$status" = "install ok installed" ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  finish
fi

case "$(. /etc/os-release && echo "${ID:-} ${VERSION_ID:-}")" in
  "debian 12" | "ubuntu 24.04") ;;
  *) echo "setup: softkin is made for Debian 12 and Ubuntu 24.04; trying on $system" ;;
esac
echo "setup: will install ${missing[*]}"
by_hand="apt-get update && apt-get install --no-install-recommends ${missing[*]}"
root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || fail "needs root to install packages, and there is no sudo; as root run" "  $by_hand"
  # without a terminal sudo cannot ask for a password
  [ -t 0 ] || sudo -n true 2>/dev/null || fail "sudo needs a password; as root run" "  $by_hand"
  root=(sudo)
fi
apt_get() { "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y "$@"; }
apt_get update && apt_get install --no-install-recommends "${missing[@]}" ||
  fail "the packages could not be installed; as root run" "  $by_hand"
finish
