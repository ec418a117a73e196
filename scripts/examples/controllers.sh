#!/usr/bin/env bash
# External controllers around the FMU (docs/how-to/controllers.md). What must be there: target/ugv.fmu (scripts/package.sh).
#   scripts/examples/controllers.sh slip_control [--help]   an SSP with a controller FMU that limits slip, run by fmpy and libcosim
#   scripts/examples/controllers.sh slalom [--help]         a gymnasium environment, and an agent that learns a slalom in it
# Tools that only these need go into virtual environments of their own: target/venv-ssp, target/venv-slalom.
set -euo pipefail
caller=$PWD
# A relative one is the caller's, as for cargo.
[[ ${CARGO_TARGET_DIR:-/} == /* ]] || export CARGO_TARGET_DIR=$PWD/$CARGO_TARGET_DIR
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
root=$PWD
target=${CARGO_TARGET_DIR:-$root/target}
example=${1:-}
[[ $example == slip_control || $example == slalom ]] || {
    sed -n '2,5p' scripts/examples/controllers.sh | cut -c3- >&2
    exit 2
}
shift

fail() {
    echo "controllers: $1" >&2
    exit 1
}

# A virtual environment with what a requirements file lists; done once for each content of the file.
environment() {
    local venv=$1 requirements=$2 stamp
    stamp="$(python3 -V) $PWD $(sha256sum <"$requirements")"
    [[ "$(cat "$venv/stamp" 2>/dev/null)" == "$stamp" ]] && return
    echo "controllers: installing $requirements into $venv" >&2
    rm -rf "$venv"
    python3 -m venv "$venv"
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary=:all: -r "$requirements" ||
        fail "pip could not install $requirements (message above); check the network or pip's index settings, then run $0 again"
    echo "$stamp" >"$venv/stamp"
}

if [[ $example == slip_control ]]; then
    ./scripts/setup.sh demo >&2
    environment target/venv-ssp scripts/examples/controllers/slip_control/requirements.txt
    arguments=(-m controllers.slip_control --libcosim "$root/target/venv-ssp/bin/python")
    # libcosim does not set enumerations: the vehicle that starts on dry sand.
    if [[ " $* " != *" --ugv "* && -x $target/release/ugv && -f $target/fmu/ugv.so ]]; then
        mkdir -p "$target/controllers"
        "$target/release/ugv" package --library "linux64=$target/fmu/ugv.so" --terrain dry_sand --output "$target/controllers/ugv.fmu" --force >&2
        arguments+=(--ugv "$target/controllers/ugv.fmu")
    fi
    python=$root/target/venv/bin/python
else
    environment target/venv-slalom scripts/examples/controllers/slalom/requirements.txt
    arguments=(-m controllers.slalom)
    python=$root/target/venv-slalom/bin/python
fi
# Paths that are given are the caller's; modules are not (PYTHONSAFEPATH).
cd "$caller"
PYTHONPATH=$root/scripts/examples PYTHONSAFEPATH=1 exec "$python" "${arguments[@]}" "$@"
