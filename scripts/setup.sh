#!/usr/bin/env bash
# Installs what softkin needs to build (with --tests: also what its tests need; with --python: what its Python package
# needs of PYTHON, python3 if not said; with --arm: what building for aarch64 and running it here needs; with --tidy: what
# `make tidy` reads the sources with), and only what is missing.
# Exit codes: 0 everything is there, 2 it is not and could not be installed.
set -euo pipefail

packages=(clang g++ cmake ninja-build libeigen3-dev libyaml-cpp-dev nlohmann-json3-dev libpugixml-dev zlib1g-dev libpng-dev
          libcli11-dev libmetis-dev libnanoflann-dev libqhull-dev libboost-dev)
# builds the page of softkin view and --html; any npm with Node.js 18 or later does
command -v npm >/dev/null || packages+=(npm)
case "${1:-}" in
  "") ;;
  --tests)
    packages+=(libgtest-dev clang-format-14 libopencv-dev libclang-rt-dev lld)
    command -v "${SOFTKIN_CHROMIUM:-chromium}" >/dev/null || packages+=(chromium)
    ;;
  --python)
    python=${PYTHON:-python3}
    "$python" -c 'import ensurepip, venv' 2>/dev/null || packages+=(python3-venv)
    "$python" -c 'import os, sysconfig; os.stat(sysconfig.get_path("include") + "/Python.h")' 2>/dev/null || packages+=(python3-dev)
    ;;
  --arm) packages+=(g++-aarch64-linux-gnu qemu-user) ;;
  --tidy) packages+=(clang-tidy-14 libopencv-dev) ;;
  *) echo "usage: scripts/setup.sh [--tests | --python | --arm | --tidy]" >&2; exit 2 ;;
esac

fail() {
  printf 'setup: %s\n' "$@" >&2
  exit 2
}

system="this system"
if [ -r /etc/os-release ]; then
  system=$(. /etc/os-release && echo "${PRETTY_NAME:-${ID:-this system}}")
fi
if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  fail "$system has no apt; softkin is made for Debian 12 and Ubuntu 24.04." \
       "Install a C++20 compiler (clang 14, gcc 12 or later), CMake 3.22, Ninja, Eigen 3.4, yaml-cpp, nlohmann-json," \
       "pugixml, zlib, libpng, CLI11, METIS, nanoflann, Qhull and Boost 1.74, with their headers, and Node.js 18 with npm for the page;" \
       "for the tests also GoogleTest, clang-format 14, clang with libFuzzer, lld, and Chromium;" \
       "for softkin measure OpenCV 4.5 or 4.6." \
       "Then run make again with SETUP=true, e.g.: make run SETUP=true"
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)
  [ "$status" = "install ok installed" ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  exit 0
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
