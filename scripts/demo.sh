#!/usr/bin/env bash
# From a fresh machine to a driving FMU: installs what is missing, builds target/ugv.fmu, drives it on four terrains
# and leaves target/demo/index.html. Needs Rust, Python 3.11 or newer and gcc.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

command -v cargo >/dev/null || {
    echo "demo: Rust is missing; install it with rustup, open a new shell and run $0 again" >&2
    exit 1
}

echo "demo 1/3: Python tools into target/venv (1.9 GB the first time)"
./scripts/setup.sh demo
echo "demo 2/3: the FMU, target/ugv.fmu (the first time some minutes of compiling)"
./scripts/package.sh
echo "demo 3/3: six seconds of driving on each of four terrains, then a controlled figure of eight"
target/venv/bin/python scripts/examples/demo.py --fmu "${CARGO_TARGET_DIR:-target}/ugv.fmu" --output target/demo
