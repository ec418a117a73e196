#!/usr/bin/env bash
# Soaks the FMU: soak.sh [--steps N] [--instances N] drives it through FMI 2.0 and 3.0 for N steps (default
# 100000000: about 25 min on an idle machine), then creates, drives and frees N instances (default 100000),
# and fails unless the memory stays flat. Shows progress with the time left, and prints a table. UGV_FMU names
# the FMU; without it target/ugv.fmu serves, which is built if it is not there.
set -euo pipefail
caller=$PWD
# A relative one is the caller's, as for cargo.
[[ ${CARGO_TARGET_DIR:-/} == /* ]] || export CARGO_TARGET_DIR=$PWD/$CARGO_TARGET_DIR
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
target=${CARGO_TARGET_DIR:-$PWD/target}

fail() {
    echo "soak: $1" >&2
    exit 1
}

steps=100000000 instances=100000
while [[ $# -gt 0 ]]; do
    case $1 in
    --steps | --instances)
        [[ "${2:-}" =~ ^[1-9][0-9]*$ ]] || fail "$1 needs a whole number above 0"
        declare "${1#--}=$2"
        shift 2
        ;;
    -h | --help)
        sed -n '2,/^set/s/^# \{0,1\}//p' scripts/tools/soak.sh
        exit 0
        ;;
    *) fail "no such option: $1; there are --steps N and --instances N" ;;
    esac
done

./scripts/setup.sh >&2
fmu=${UGV_FMU:-$target/ugv.fmu}
[[ $fmu == /* ]] || fmu=$caller/$fmu
[[ -n "${UGV_FMU:-}" || -f $fmu ]] || ./scripts/package.sh >&2
[[ -f $fmu ]] || fail "$fmu is not there; build it with scripts/package.sh, or name another in UGV_FMU"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
target/venv/bin/python -m zipfile -e "$fmu" "$work"
guid=$(sed -nE 's/.* guid="([^"]+)".*/\1/p' "$work/modelDescription.xml")
[[ -n $guid ]] || fail "$fmu is no FMU of FMI 2.0; name one that ugv package made without --fmi 3"
headers=$(dirname "$(find target/venv/lib/ -path '*/fmpy/c-code/fmi3Functions.h')")
gcc -std=c11 -D_GNU_SOURCE -O2 -I "$headers" -I modelDescription -o "$work/soak" tests/fmu/soak.c -ldl -lm
"$work/soak" "$work/binaries/linux64/ugv.so" "$work/resources/" "file://$work/resources" "$guid" "$steps" "$instances"
