#!/usr/bin/env bash
# Sets up what is missing, builds the FMU, and runs every test: Rust (unit, golden, limits,
# properties, tool, C interface) and Python (the FMU through its importers, the demo).
# With UGV_PLATFORMS=all the FMU has, and the tests drive, the libraries for win64 and aarch64-linux as well.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

export UGV_DATA=${UGV_DATA:-../shared/data}
./scripts/package.sh --platforms "${UGV_PLATFORMS:-linux64}"
# A failure does not keep what comes after it from being told.
status=0
echo "test: Rust"
cargo test --locked --release --features fmu --no-fail-fast || status=1
echo "test: Python"
# A module on each of two cores; those that skip tell why.
target/venv/bin/python -m pytest tests/python --numprocesses 2 --dist loadfile --no-loadscope-reorder -p no:cacheprovider -q -rs --durations 12 || status=1
exit $status
