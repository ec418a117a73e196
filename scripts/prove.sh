#!/usr/bin/env bash
# Proves `ugv diagnose`: draws new cases with a sealed truth from an independent simulator, has the tool and its peers
# answer them, opens the truth afterwards, and writes DIR/proof.html, proof.json and cases.csv. Options: scripts/prove.sh --help.
# `scripts/prove.sh altered` conceals changes in real recordings instead (UGV_DATA; scripts/prove.sh altered --help),
# `scripts/prove.sh draw` only draws cases (scripts/prove.sh draw --help).
# `scripts/prove.sh agree` tells how far the generator's motion is from the library's (scripts/prove.sh agree --help).
# UGV_TOOL names a binary to prove in place of the one that is built here.
set -euo pipefail
caller=$PWD
# A relative one is the caller's, as for cargo.
[[ ${CARGO_TARGET_DIR:-/} == /* ]] || export CARGO_TARGET_DIR=$PWD/$CARGO_TARGET_DIR
cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=$PWD
target=${CARGO_TARGET_DIR:-$root/target}

module=judge
case "${1:-}" in
altered)
    module=altered
    shift
    ;;
agree)
    module=agreement
    shift
    ;;
draw)
    module=generator
    shift
    ;;
esac
./scripts/setup.sh proof >&2
arguments=(-m "$module")
if [[ $module != generator ]]; then
    arguments+=(--tool "${UGV_TOOL:-$target/release/ugv}")
    if [[ -z "${UGV_TOOL:-}" && " $* " != *" --help "* && " $* " != *" -h "* ]]; then
        cargo build --locked --release --bin ugv ${UGV_FEATURES:+--features "$UGV_FEATURES"} >&2
    fi
fi
# Paths that are given are the caller's; modules are not (PYTHONSAFEPATH).
cd "$caller"
PYTHONPATH=$root/scripts/proof PYTHONSAFEPATH=1 exec "$root/target/venv/bin/python" "${arguments[@]}" "$@"
