#!/usr/bin/env bash
# Sets up what is missing, builds the FMU, and runs every test: Rust (unit, golden, limits,
# properties, tool, C interface) and Python (the FMU through its importers, the demo).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

export UGV_DATA=${UGV_DATA:-../shared/data}
./scripts/package.sh
echo "test: Rust"
cargo test --locked --release --features fmu
echo "test: Python"
target/venv/bin/python -m unittest discover -s tests/python
