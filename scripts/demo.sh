#!/usr/bin/env bash
# From a fresh machine to a mended model: installs what is missing, builds the tool and target/ugv.fmu, drives it on
# four terrains, diagnoses a shipped recording, and leaves target/demo/index.html. Needs Rust, Python 3.11 or newer
# and gcc; takes seven minutes on two idle cores.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

command -v cargo >/dev/null || {
    echo "demo: Rust is missing; install it with rustup, open a new shell and run $0 again" >&2
    exit 1
}

echo "demo 1/3: Python tools into target/venv (400 MB the first time)"
./scripts/setup.sh demo
echo "demo 2/3: the FMU, target/ugv.fmu (the first time some minutes of compiling)"
./scripts/package.sh
echo "demo 3/3: four terrains, a controlled figure of eight, a recording diagnosed (a minute)"
target/venv/bin/python scripts/examples/demo.py --fmu "${CARGO_TARGET_DIR:-target}/ugv.fmu" --output target/demo
