#!/usr/bin/env bash
# Fills a folder with the libraries and headers of programs for aarch64: it fetches and unpacks Debian 12's packages,
# so that this machine's own packages do not change and root is not needed. cmake/aarch64.cmake builds with it; the
# programs run under qemu. The script needs g++-aarch64-linux-gnu, qemu-user, and a Debian 12 whose apt reaches its
# mirror.
#   scripts/arm_sysroot.sh [FOLDER]   FOLDER: build-arm/sysroot; 0.5 GiB; not changed if it is complete
# Exit codes: 0 the folder is complete, 1 a package could not be fetched, 2 usage.
set -euo pipefail

packages=(libc6-dev libstdc++-12-dev libeigen3-dev libyaml-cpp-dev nlohmann-json3-dev libpugixml-dev zlib1g-dev libpng-dev
          libcli11-dev libmetis-dev libnanoflann-dev libqhull-dev libboost1.74-dev libboost-dev libhwy-dev libgtest-dev
          libpython3-dev python3-minimal)
case "${1:-}" in -*) sed -n '2,7s/^# //p' "$0" >&2; exit 2 ;; esac
folder=${1:-$(dirname "$0")/../build-arm/sysroot}
done_with="$folder/packages.txt"
[ "$(cat "$done_with" 2>/dev/null)" != "${packages[*]}" ] || exit 0

mirror=$(apt-get indextargets --format '$(SITE)' 'Created-By: Packages' 'Codename: bookworm' | head -n 1)
if [ -z "$mirror" ]; then
  echo "arm_sysroot: apt has no mirror of Debian 12 (bookworm) here" >&2
  exit 2
fi
rm -rf "$folder"
mkdir -p "$folder"
folder=$(realpath "$folder")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work"/{lists,archives,parts}/partial "$work/etc"
: >"$work/status"
echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror bookworm main" >"$work/sources.list"
apt_get() {
  apt-get -q -y -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State::status="$work/status" \
    -o Dir::State::lists="$work/lists" -o Dir::Cache="$work" -o Dir::Cache::archives="$work/archives" \
    -o Dir::Etc::sourcelist="$work/sources.list" -o Dir::Etc::sourceparts="$work/parts" -o Debug::NoLocking=true \
    -o APT::Sandbox::User="$(id -un)" "$@" >"$work/log" 2>&1 || { tail -n 5 "$work/log" >&2; exit 1; }
}
apt_get update
apt_get install --no-install-recommends --download-only "${packages[@]}"
# links first: the files that Debian unpacks into /lib belong below /usr
mkdir -p "$folder/usr/lib" "$folder/usr/bin" "$folder/usr/sbin"
ln -s usr/lib usr/bin usr/sbin "$folder"
for package in "$work"/archives/*.deb; do
  dpkg-deb --fsys-tarfile "$package" | tar -x --keep-directory-symlink --no-same-owner -C "$folder"
done
# absolute links would point out of the folder
find "$folder" -type l -lname '/*' -printf '%p\n%l\n' | while read -r link && read -r to; do
  ln -sfn "$(realpath -m --relative-to "$(dirname "$link")" "$folder$to")" "$link"
done
echo "${packages[*]}" >"$done_with"
