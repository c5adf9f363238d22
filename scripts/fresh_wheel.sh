#!/usr/bin/env bash
# Measures the first steps of a user who has only a wheel and Python: in a new Debian 12 and a new Ubuntu 24.04, made
# with debootstrap in a folder, it installs the wheel, copies and bends an example, and makes its page. It needs root,
# debootstrap, and this machine's settings of pip, which it copies to the new systems (pip fetches NumPy).
#   scripts/fresh_wheel.sh FOLDER WHEEL...   FOLDER: 1 GiB, kept; WHEEL: for Python 3.11 or 3.12, from scripts/wheels.sh
#   UBUNTU: its mirror (default: http://archive.ubuntu.com/ubuntu); SECONDS_ALLOWED (default: 60)
# Exit codes: 0 every available system completes the steps in time, 1 a step fails or takes longer, 2 usage, or no
# system is available.
set -euo pipefail

[ $# -ge 2 ] && [ "$(id -u)" -eq 0 ] && command -v debootstrap >/dev/null || {
  sed -n '2,8s/^# //p' "$0" >&2
  exit 2
}
folder=$(realpath -m "$1")
shift
wheels=("$@")
allowed=${SECONDS_ALLOWED:-60}
debian=$(apt-get indextargets --format '$(SITE)' 'Created-By: Packages' 'Codename: bookworm' 2>/dev/null | head -n 1)
ubuntu=${UBUNTU:-http://archive.ubuntu.com/ubuntu}

# fresh NAME SUITE MIRROR: makes a system with Python, or prints why it cannot
fresh() {
  local root=$folder/$1 options=() unchecked=
  [ ! -e "$root/softkin" ] || return 0
  if ! curl --silent --fail --head --location --max-time 20 --output /dev/null "$3/dists/$2/Release"; then
    echo "fresh_wheel: $1 was not tried: $3 cannot be reached"
    return 1
  fi
  if [ "$2" = noble ]; then
    [ -e /usr/share/debootstrap/scripts/noble ] || options=(gutsy)  # all of Ubuntu's are made alike
    # Debian has no keys of Ubuntu, so that the packages are not verified; they stay in this folder
    [ -e /usr/share/keyrings/ubuntu-archive-keyring.gpg ] || unchecked=--no-check-gpg
  fi
  mkdir -p "$folder/archives/$1"
  if ! debootstrap --variant=minbase --cache-dir="$folder/archives/$1" --components="main$([ "$2" != noble ] || echo ,universe)" $unchecked \
    --include=ca-certificates,python3,python3-venv "$2" "$root" "$3" "${options[@]}" >"$folder/$1.log" 2>&1; then
    tail -n 5 "$folder/$1.log" >&2
    return 1
  fi
  cp -a /etc/ssl/certs/. "$root/etc/ssl/certs/"
  cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
  [ ! -f /etc/pip.conf ] || cp /etc/pip.conf "$root/etc/"
  mkdir "$root/softkin"
}

inside() { # NAME COMMAND: runs a command with the variables that pip reads, and with /proc for libraries
  local root=$folder/$1
  shift
  local settings
  mapfile -t settings < <(env | grep -iE '^(pip_|https?_proxy|no_proxy)' || true)
  env -i "${settings[@]}" PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
    unshare --mount bash -euc 'mount -t proc proc "$0/proc" && exec chroot "$0" bash -euo pipefail -c "cd /softkin && $1"' \
    "$root" "$*"
}

now() { date +%s.%N; }
minus() { awk "BEGIN { printf \"%.1f\", $1 - $2 }"; }

# try NAME: runs every step in turn
try() {
  local name=$1 begin from
  rm -rf "$folder/$name/softkin"
  mkdir "$folder/$name/softkin"
  cp "${wheels[@]}" "$folder/$name/softkin/"
  if inside "$name" "command -v c++ || command -v gcc" >/dev/null; then
    echo "fresh_wheel: $name has a compiler, which should not be there" >&2
    return 1
  fi
  local tag wheel
  tag=$(inside "$name" "python3 -c 'import sys; print(*sys.version_info[:2], sep=\"\")'")
  wheel=$(cd "$folder/$name/softkin" && ls softkin-*-cp"$tag"-*.whl 2>/dev/null | head -n 1)
  if [ -z "$wheel" ]; then
    echo "fresh_wheel: $name was not tried: none of the wheels is for its Python ($tag)"
    return 0
  fi
  tried=$((tried + 1))
  local steps=(
    "a folder for packages" "python3 -m venv venv"
    "install the wheel" "venv/bin/pip install --quiet ./$wheel"
    "copy an example" "venv/bin/softkin examples copy finger"
    "bend it" "venv/bin/softkin fk pneumatic_finger/pneumatic_finger.yaml --set air=1.4 --image bent.png"
    "make its page" "venv/bin/softkin fk pneumatic_finger/pneumatic_finger.yaml --set air=1.4 --html bent.html"
  )
  begin=$(now)
  echo "$name: $(inside "$name" '. /etc/os-release; echo "$PRETTY_NAME, $(python3 --version)"')"
  for ((i = 0; i < ${#steps[@]}; i += 2)); do
    from=$(now)
    inside "$name" "${steps[i + 1]}" >"$folder/step.log" 2>&1 || { cat "$folder/step.log" >&2; return 1; }
    printf '  %-24s %6s s\n' "${steps[i]}" "$(minus "$(now)" "$from")"
  done
  local taken
  taken=$(minus "$(now)" "$begin")
  inside "$name" "venv/bin/python -W ignore -c 'import softkin; softkin.load(softkin.example(\"chambers\")).solve(air1=1.2).require()'" || return 1
  [ -s "$folder/$name/softkin/bent.png" ] && grep -q 'id="softkin-page"' "$folder/$name/softkin/bent.html" || return 1
  printf '  %-24s %6s s\n' "in all" "$taken"
  awk "BEGIN { exit !($taken <= $allowed) }" || { echo "fresh_wheel: longer than $allowed s" >&2; return 1; }
}

tried=0 code=0
for system in "debian_12 bookworm $debian" "ubuntu_24_04 noble $ubuntu"; do
  read -r name suite mirror <<<"$system"
  fresh "$name" "$suite" "$mirror" || continue
  try "$name" || code=1
done
[ "$tried" -gt 0 ] || exit 2
exit "$code"
