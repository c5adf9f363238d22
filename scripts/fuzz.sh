#!/usr/bin/env bash
# Runs libFuzzer on every reader (tests/fuzz), one process per core, and prints a table at the end.
#   scripts/fuzz.sh PROGRAM quick [TARGET...]   SECONDS_IN_ALL (60) for all together, from one seed; keeps no corpus
#   scripts/fuzz.sh PROGRAM full [TARGET...]    RUNS (2000000) inputs for each; continues from out/fuzz
# Exit codes: 0 nothing found, 1 a reader failed (the table names the input that did it, in out/fuzz/finds), 2 usage.
set -euo pipefail

corpora=$(dirname "$0")/../tests/fuzz
out=out/fuzz
chunk=100000   # inputs between two records of the progress of a target
seed=1
limits=(-max_len=4096 -timeout=20 -rss_limit_mb=2048 -malloc_limit_mb=512 -print_final_stats=1)

usage() {
  sed -n '2,5s/^# //p' "$0" >&2
  exit 2
}

last_number() { sed -n "s/.*$1 *\([0-9]*\).*/\1/p" "$2" | tail -n 1; }

# fuzz TARGET DICTIONARY CORPUS OPTIONS...: one run of the program; adds to the table's row, 1 where it failed
fuzz() {
  local target=$1 dictionary=$2 corpus=$3 log=$rows/$1.log failed=0
  shift 3
  mkdir -p "$corpus" "$out/finds"
  local begin=$(date +%s%3N)
  TMPDIR=$rows "$program" "--target=$target" "-dict=$corpora/$dictionary" "${limits[@]}" "$@" \
    "-artifact_prefix=$out/finds/$target-" "$corpus" "$corpora/corpus/$target" >"$log" 2>&1 || failed=1
  inputs=$(last_number 'number_of_executed_units:' "$log")
  local find=none
  if [ $failed -ne 0 ]; then
    find=$(sed -n 's/.*Test unit written to //p' "$log" | tail -n 1)
    find=${find:-"no input; its end: $(tail -n 1 "$log")"}
    cp "$log" "$out/finds/$target.log"
  fi
  echo "$target ${inputs:=0} $(($(date +%s%3N) - begin)) $(last_number 'cov:' "$log") $find" >>"$rows/$target.row"
  return $failed
}

run_quick() {
  fuzz "$1" "$2" "$rows/$1.corpus" "-seed=$seed" "-max_total_time=$each" || true
}

run_full() {
  local done_file=$out/$1.inputs done=0
  [ ! -f "$done_file" ] || done=$(<"$done_file")
  echo "$1 $done 0 0 none" >>"$rows/$1.row"   # of earlier calls
  while [ "$done" -lt "$runs" ]; do
    local left=$((runs - done))
    fuzz "$1" "$2" "$out/$1" "-seed=$((seed + done))" "-runs=$((left < chunk ? left : chunk))" || return 0
    done=$((done + inputs))
    echo "$done" >"$done_file"
  done
}

# The rows of a target together. A row: TARGET INPUTS MILLISECONDS COVERAGE FIND, no milliseconds for earlier calls.
print_table() {
  printf '%-16s %10s %9s %9s  %s\n' target inputs inputs/s coverage failed
  cat "$rows"/*.row | awk '
    { inputs[$1] += $2
      if ($3 > 0) { fresh[$1] += $2; time[$1] += $3; cover[$1] = $4 }
      if ($5 != "none") { found[$1] = substr($0, index($0, $5)); failed = 1 } }
    END { for (t in inputs)
            printf "%-16s %10d %9d %9s  %s\n",
                   t, inputs[t], time[t] ? 1000 * fresh[t] / time[t] : 0, cover[t], found[t] | "sort"
          close("sort")
          exit failed }'
}

if [ "${1:-}" = --one ]; then   # for xargs below: MODE TARGET DICTIONARY
  "run_$2" "$3" "$4"
  exit
fi

[ $# -ge 2 ] && [ -x "$1" ] && [[ $2 =~ ^(quick|full)$ ]] || usage
export program=$1 mode=$2 rows runs=${RUNS:-2000000} each
shift 2
all=$("$program" --list)
chosen=$(for target in "${@:-.*}"; do
  grep -E "^$target " <<<"$all" || { echo "no target $target; there are:" $(cut -d' ' -f1 <<<"$all") >&2; exit 2; }
done)
cores=$(nproc)
each=$((${SECONDS_IN_ALL:-60} * cores / $(wc -l <<<"$chosen")))
[ $each -gt 0 ] || each=1
# readers take files: on a disk in memory where there is one
rows=$(mktemp -d /dev/shm/softkin_fuzz.XXXXXX 2>/dev/null || mktemp -d)
trap 'rm -rf "$rows"' EXIT
budget="$runs inputs each"
[ "$mode" = full ] || budget="$each s each"
echo "fuzz: $(wc -l <<<"$chosen") targets, seed $seed, $budget, $cores at once"
xargs -P "$cores" -L 1 "$0" --one "$mode" <<<"$chosen" || true
print_table
