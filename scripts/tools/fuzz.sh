#!/usr/bin/env bash
# Fuzzes the readers and the C interfaces: fuzz.sh [--seconds N] [TARGET...] runs each target (default: all) for its
# share of N seconds (default 3600), one after the other, from the seeds in tests/fuzz/seeds, and prints a table of
# executions, coverage and findings. What is found stays in target/fuzz: corpus/TARGET, and artifacts/TARGET with
# inputs that crash, leak, take more than 20 s or more than 3 GB (1.1 GB at once). Exit code 1 if there are any.
# Needs cargo-fuzz (cargo install cargo-fuzz) and a C++ compiler; a stable Rust will do, as RUSTC_BOOTSTRAP unlocks
# the sanitizer in it. UGV_SANITIZER=none runs without AddressSanitizer.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

fail() {
    echo "fuzz: $1" >&2
    exit 1
}

all=(recording json import fmi2 fmi3)
seconds=3600 targets=()
while [[ $# -gt 0 ]]; do
    case $1 in
    --seconds)
        [[ "${2:-}" =~ ^[1-9][0-9]*$ ]] || fail "--seconds needs a whole number above 0"
        seconds=$2
        shift
        ;;
    -h | --help)
        sed -n '2,/^set/s/^# \{0,1\}//p' scripts/tools/fuzz.sh
        exit 0
        ;;
    *)
        [[ " ${all[*]} " == *" $1 "* ]] || fail "no such target: $1; there are ${all[*]}"
        targets+=("$1")
        ;;
    esac
    shift
done
[[ ${#targets[@]} -gt 0 ]] || targets=("${all[@]}")
cargo fuzz --version >/dev/null 2>&1 || fail "cargo-fuzz is missing; install it: cargo install cargo-fuzz --locked"
command -v c++ >/dev/null || fail "a C++ compiler is missing; install it (Debian: apt-get install g++)"

./scripts/setup.sh >&2
work=$PWD/target/fuzz
share=$((seconds / ${#targets[@]}))
[[ $share -gt 0 ]] || fail "--seconds $seconds is less than one for each of ${#targets[@]} targets"
export RUSTC_BOOTSTRAP=1
flags=(--fuzz-dir tests/fuzz --target-dir "${CARGO_TARGET_DIR:-target}/fuzz" --release
    --sanitizer "${UGV_SANITIZER:-address}")
for target in "${targets[@]}"; do
    cargo fuzz build "${flags[@]}" "$target" >&2
done

table="| Target | Seconds | Executions | Edges covered | Corpus | Findings |"$'\n'"|---|---:|---:|---:|---:|---:|"
found=0
for target in "${targets[@]}"; do
    corpus=$work/corpus/$target artifacts=$work/artifacts/$target log=$work/$target.log
    mkdir -p "$corpus" "$artifacts"
    # Long from the start: a few bytes are no sequence of calls that gets anywhere.
    more=()
    [[ $target != fmi* ]] || more=(-len_control=0)
    echo "fuzz: $target for $share s, log in $log" >&2
    # After a finding it goes on, for as long as there is time.
    begin=$SECONDS runs=0
    : >"$log"
    while left=$((share - SECONDS + begin)) && [[ $left -gt 0 ]]; do
        cargo fuzz run "${flags[@]}" "$target" "$corpus" "tests/fuzz/seeds/$target" -- -max_total_time="$left" \
            -artifact_prefix="$artifacts/" -timeout=20 -report_slow_units=20 -rss_limit_mb=3000 -malloc_limit_mb=1100 -max_len=4096 \
            "${more[@]}" -print_final_stats=1 >"$log.part" 2>&1 || true
        cat "$log.part" >>"$log"
        runs=$((runs + $(sed -nE 's/^stat::number_of_executed_units: +([0-9]+)$/\1/p' "$log.part" | tail -n 1)+0))
        grep -q '^stat::' "$log.part" || fail "$target does not run: $(tail -n 3 "$log.part")"
    done
    covered=$(grep -oE 'cov: [0-9]+' "$log" | tail -n 1 | cut -d ' ' -f 2)
    crashes=$(find "$artifacts" -type f | wc -l)
    found=$((found + crashes))
    table+=$'\n'"| \`$target\` | $((SECONDS - begin)) | $runs | $covered | $(find "$corpus" -type f | wc -l) | $crashes |"
done
rm -f "$work"/*.log.part
echo "$table"
[[ $found -eq 0 ]] || fail "there are findings in $work/artifacts; cargo fuzz run --fuzz-dir tests/fuzz TARGET FILE repeats one"
