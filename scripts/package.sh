#!/usr/bin/env bash
# Builds the FMU's shared library and the tool, and leaves target/ugv.fmu (FMI 2.0) and
# target/ugv-fmi3.fmu (FMI 3.0), both with that library.
# Arguments are passed on to `ugv package` (--vehicle, --terrain, --output ...).
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
"$here/setup.sh"
"$here/build_fmu_library.sh"
target=${CARGO_TARGET_DIR:-$here/../target}
cargo build --manifest-path "$here/../Cargo.toml" --locked --release --quiet
package=("$target/release/ugv" package --library "linux64=$target/fmu/ugv.so")
"${package[@]}" "$@" --fmi 3 --output "$target/ugv-fmi3.fmu"
"${package[@]}" --output "$target/ugv.fmu" "$@"
