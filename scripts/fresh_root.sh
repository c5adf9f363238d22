# Functions of scripts that test softkin on a new Debian 12, made with debootstrap in a folder, with this machine's
# settings of apt and pip. The script that reads this file sets `folder`, the folder of the systems, and `name`, its
# name in messages.
mirror=$(apt-get indextargets --format '$(SITE)' 'Created-By: Packages' | head -n 1)

# fresh NAME PACKAGES: makes a system, with an archive of packages that all systems use
fresh() {
  local root=$folder/$1
  [ ! -e "$root" ] || { echo "${name:-fresh}: $root exists; remove it" >&2; exit 2; }
  mkdir -p "$folder/archives"
  debootstrap --variant=minbase --cache-dir="$folder/archives" --include="ca-certificates,python3,python3-venv$2" bookworm \
    "$root" "$mirror" >"$folder/$1.log" 2>&1 || { tail -n 5 "$folder/$1.log" >&2; exit 1; }
  rm "$root/etc/apt/sources.list"
  cp -a /etc/apt/. "$root/etc/apt/"
  cp -a /etc/ssl/certs/. "$root/etc/ssl/certs/"
  cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
  [ ! -f /etc/pip.conf ] || cp /etc/pip.conf "$root/etc/"
}

# inside NAME COMMAND: runs a command in a system, with the variables that pip and apt read, with /proc, by which
# programs find their libraries, and with /dev. If `cache` names a folder, the system has it as /ccache.
inside() {
  local root=$folder/$1
  shift
  local settings
  mapfile -t settings < <(env | grep -iE '^(pip_|https?_proxy|no_proxy)' || true)
  [ -z "${cache:-}" ] || { mkdir -p "$root/ccache" && settings+=("cache=$cache" CCACHE_DIR=/ccache); }
  env -i "${settings[@]}" PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
    unshare --mount bash -euc 'mount -t proc proc "$0/proc" && mount --rbind /dev "$0/dev"
      [ -z "${cache:-}" ] || mount --bind "$cache" "$0/ccache"
      exec chroot "$0" bash -euo pipefail -c "$1"' "$root" "$*"
}
