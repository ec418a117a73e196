#!/usr/bin/env bash
# Measures the model, the FMU and a NumPy/SciPy peer in one run, and prints a table (Markdown).
# Takes some minutes; close other programs first. Details of each figure: target/criterion.
set -euo pipefail
# A relative one is the caller's, as for cargo.
[[ ${CARGO_TARGET_DIR:-/} == /* ]] || export CARGO_TARGET_DIR=$PWD/$CARGO_TARGET_DIR
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

./scripts/package.sh
./scripts/setup.sh proof
venv=$PWD/target/venv
target=${CARGO_TARGET_DIR:-$PWD/target}
export UGV_DRIVE=$target/bench/drive.csv
mkdir -p "$target/bench"
"$venv/bin/python" scripts/tools/numpy_model.py drive --output "$UGV_DRIVE"

echo "bench: the model in Rust (criterion)"
cargo bench --locked --bench model -- --quiet | tee "$target/bench/criterion.txt"

echo "bench: the FMU from C"
headers=$(dirname "$(find "$venv"/lib/ -path '*/fmpy/c-code/fmi2Functions.h')")
gcc -O2 -I"$headers" -o "$target/bench/fmu_steps" tests/bench/fmu_steps.c -ldl
rm -rf "$target/bench/fmu" && mkdir "$target/bench/fmu"
"$venv/bin/python" -m zipfile -e "$target/ugv.fmu" "$target/bench/fmu"
guid=$(sed -nE 's/.* guid="([^"]+)".*/\1/p' "$target/bench/fmu/modelDescription.xml")
"$target/bench/fmu_steps" "$target/bench/fmu/binaries/linux64/ugv.so" "$guid" \
    "file://$target/bench/fmu/resources" "$UGV_DRIVE" | tee "$target/bench/fmu.json"

echo "bench: the same model in NumPy and SciPy"
"$venv/bin/python" scripts/tools/numpy_model.py bench --json "$target/bench/numpy.json"

"$venv/bin/python" scripts/tools/bench_table.py | tee "$target/bench/table.md"
