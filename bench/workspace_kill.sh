#!/usr/bin/env bash
# Samples a workspace undisturbed, then again, killed with SIGKILL at random instants and resumed; with a softkin built
# with MPI also on one and two ranks of one thread each. Prints times, and fails where a file differs by a byte.
#
# usage: bench/workspace_kill.sh [SOFTKIN] [SAMPLES] [KILLS] [ORDER]
#   ORDER  of the mesh of examples/three_tendon_finger: 2 as shipped, or 1, which is quick
set -euo pipefail

softkin=${1:-build/softkin} samples=${2:-3375} kills=${3:-20} order=${4:-2}
example=$(dirname "$0")/../examples/three_tendon_finger
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp "$example/three_tendon_finger.msh" "$folder"
sed "s/order: 2/order: $order/" "$example/three_tendon_finger.yaml" > "$folder/finger.yaml"

now() { date +%s.%N; }
since() { awk -v a="$1" -v b="$(now)" 'BEGIN { printf "%.1f", b - a }'; }
rows() { if [ -e "$1" ]; then grep -cv '^[#s]' "$1" || true; else echo 0; fi; }
same() { cmp "$folder/undisturbed.csv" "$1" && echo "  the same file, byte for byte"; }
command=("$softkin" workspace "$folder/finger.yaml" --samples "$samples")

echo "three-tendon finger, mesh of order $order, $samples samples"
start=$(now)
"${command[@]}" -o "$folder/undisturbed.csv" > "$folder/log"
whole=$(since "$start")
echo "undisturbed, all cores: $whole s; $(grep converged "$folder/log")"

RANDOM=1
start=$(now)
done_kills=0
while [ "$done_kills" -lt "$kills" ]; do
  "${command[@]}" -o "$folder/killed.csv" --resume > "$folder/log" 2>&1 &
  process=$!
  # anywhere in a piece of the way that leaves room for all kills
  sleep "$(awk -v w="$whole" -v k="$kills" -v r="$RANDOM" 'BEGIN { print 0.2 + 1.6 * r / 32768 * w / (k + 2) }')"
  if ! kill -KILL "$process" 2> "$folder/log"; then
    wait "$process" || true
    break
  fi
  wait "$process" 2> "$folder/log" || true
  done_kills=$((done_kills + 1))
  printf '%s ' "$(rows "$folder/killed.csv")"
done
echo "rows after each of $done_kills kills"
"${command[@]}" -o "$folder/killed.csv" --resume > "$folder/log"
echo "killed $done_kills times and resumed: $(since "$start") s"
same "$folder/killed.csv"
[ "$(cut -d, -f1 "$folder/killed.csv" | grep -v '^[#s]' | sort | uniq -d | wc -l)" -eq 0 ]

if ! ldd "$softkin" | grep -q libmpi; then
  echo "ranks: skipped, $softkin was built without MPI (-DSOFTKIN_MPI=ON)"
  exit 0
fi
[ "$(id -u)" -ne 0 ] || export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
for ranks in 1 2; do
  start=$(now)
  mpirun --oversubscribe -np "$ranks" "${command[@]}" --threads 1 \
    -o "$folder/ranks.csv" > "$folder/log"
  seconds=$(since "$start")
  echo "ranks of one thread: $ranks: $seconds s"
  same "$folder/ranks.csv"
  [ "$ranks" -eq 1 ] && one=$seconds
done
awk -v a="$one" -v b="$seconds" 'BEGIN { printf "two ranks over one: %.3f\n", b / a }'
