#!/usr/bin/env bash
# Has every importer drive the FMU, each in a separate virtual environment, and compares it with the library itself:
# `scripts/tools/importers.sh [NAME...]`, `scripts/tools/importers.sh --help`. The first time it installs and compiles (some minutes, 2 GB in
# target/importers). `--page docs/contributing/importers.md` puts the table into the docs. UGV_HELD_DRIVE names a built example held_drive.
set -euo pipefail
caller=$PWD
# A relative one is the caller's, as for cargo.
[[ ${CARGO_TARGET_DIR:-/} == /* ]] || export CARGO_TARGET_DIR=$PWD/$CARGO_TARGET_DIR
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
root=$PWD
target=${CARGO_TARGET_DIR:-$root/target}

./scripts/setup.sh >&2
native=${UGV_HELD_DRIVE:-$target/release/examples/held_drive}
if [[ " $* " != *" --help "* && " $* " != *" -h "* ]]; then
    [[ -f $target/ugv.fmu && -f $target/ugv-fmi3.fmu || " $* " == *" --fmu "* ]] || ./scripts/package.sh >&2
    [[ -n "${UGV_HELD_DRIVE:-}" ]] || cargo build --locked --release --example held_drive ${UGV_FEATURES:+--features "$UGV_FEATURES"} >&2
fi
# Paths that are given are the caller's.
cd "$caller"
PYTHONPATH=$root/scripts/tools/importers exec "$root/target/venv/bin/python" "$root/scripts/tools/importers/matrix.py" --native "$native" "$@"
