#!/usr/bin/env bash
# Installs Python packages into target/venv: setup.sh [GROUP...]. Does nothing where they are there already.
#   (always)   libclang and fmpy, with which the FMU is built and driven
#   demo       what the demo and the examples draw with
#   proof      the independent simulator of scripts/prove.sh, and its peers
#   scale      sweeps and fleets on Dask workers
#   platforms  zig, which links the FMU's library for old glibc and for Linux on ARM
#   test       what only the tests use
# The groups are the files of scripts/requirements; constraints.txt there has all versions.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

requirements=scripts/requirements
venv=target/venv

fail() {
    echo "setup: $1" >&2
    exit 1
}

for group; do
    case $group in
    demo | proof | scale | platforms | test) ;;
    -h | --help)
        sed -n '2,/^set/s/^# \{0,1\}//p' scripts/setup.sh
        exit 0
        ;;
    *) fail "there is no group $group; there are demo, proof, scale, platforms and test" ;;
    esac
done

command -v gcc >/dev/null || fail "gcc is missing; install it (Debian: apt-get install gcc libc6-dev)"
command -v python3 >/dev/null || fail "python3 is missing; install it (Debian: apt-get install python3 python3-venv)"
python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
    fail "$(python3 -V) is too old; put Python 3.11 or newer first in PATH"
python3 -c 'import ensurepip, venv' 2>/dev/null ||
    fail "Python's venv module is missing; install it (Debian: apt-get install python3-venv)"

# Another Python, another place or other versions: all groups are installed anew, each when it is asked for.
stamp="$(python3 -V) $PWD $(sha256sum <"$requirements/constraints.txt")"
if [[ "$(cat "$venv/stamp" 2>/dev/null)" != "$stamp" ]]; then
    rm -rf "$venv"
    python3 -m venv "$venv"
    echo "$stamp" >"$venv/stamp"
fi

missing=()
for group in base "$@"; do
    cmp -s "$requirements/$group.txt" "$venv/installed/$group.txt" || missing+=("$group")
done
[[ ${#missing[@]} -gt 0 ]] || exit 0

echo "setup: installing into $venv: ${missing[*]}"
files=()
for group in "${missing[@]}"; do
    files+=(-r "$requirements/$group.txt")
done
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary=:all: -c "$requirements/constraints.txt" "${files[@]}" ||
    fail "pip could not install ${missing[*]} (message above); check the network or pip's index settings, then run $0 again"

# bindgen (in fmi-sys) needs libclang and a compiler to ask for the C include folders: .cargo/config.toml names these two.
ln -sfn "$("$venv/bin/python" -c 'import clang, pathlib; print(pathlib.Path(clang.__file__).resolve().parent / "native")')" "$venv/libclang"
ln -sfn "$(command -v gcc)" "$venv/include-finder"

mkdir -p "$venv/installed"
for group in "${missing[@]}"; do
    cp "$requirements/$group.txt" "$venv/installed/"
done
echo "setup: done, $(du -sh "$venv" | cut -f 1)"
