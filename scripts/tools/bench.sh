#!/usr/bin/env bash
# Measures the model, batches, the FMU and a NumPy/SciPy peer in one run, and prints a table (Markdown).
# All of it in seconds of the processor, so that other programs disturb it little; takes some five minutes.
# Details of each figure: target/bench/*.json.
set -euo pipefail
# A relative one is the caller's, as for cargo.
[[ ${CARGO_TARGET_DIR:-/} == /* ]] || export CARGO_TARGET_DIR=$PWD/$CARGO_TARGET_DIR
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

./scripts/package.sh >&2
./scripts/setup.sh proof >&2
venv=$PWD/target/venv
target=${CARGO_TARGET_DIR:-$PWD/target}
results=$target/bench
rm -rf "$results" && mkdir -p "$results/fmu"
# One thread, as the others: its processor time would otherwise be that of all.
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

echo "bench: the model in Rust, and the drive for the others" >&2
cargo bench --locked --bench model -- "$results" >&2

echo "bench: the FMU from C" >&2
headers=$(dirname "$(find "$venv"/lib/ -path '*/fmpy/c-code/fmi2Functions.h')")
gcc -O2 -ImodelDescription -I"$headers" -o "$results/fmu_steps" tests/bench/fmu_steps.c -ldl
"$venv/bin/python" -m zipfile -e "$target/ugv.fmu" "$results/fmu"
guid=$(sed -nE 's/.* guid="([^"]+)".*/\1/p' "$results/fmu/modelDescription.xml")
for terrain in 1 2 3 4; do
    # Steps of 100, 10 and 1 ms.
    for parts in 1 10 100; do
        "$results/fmu_steps" "$results/fmu/binaries/linux64/ugv.so" "$guid" "file://$results/fmu/resources" \
            "$results/drive.csv" "$terrain" "$parts"
    done
done >"$results/fmu.jsonl"

echo "bench: the same model in NumPy and SciPy" >&2
"$venv/bin/python" scripts/tools/numpy_model.py bench --golden tests/golden --drive "$results/drive.csv" --json "$results/numpy.json"

"$venv/bin/python" scripts/tools/bench_table.py | tee "$results/table.md"
