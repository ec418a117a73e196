#!/usr/bin/env bash
# Installs the Python tools this repository uses (libclang, zig, fmpy, ...) into target/venv.
# Does nothing when they are there already and scripts/requirements.txt has not changed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

requirements=scripts/requirements.txt
venv=target/venv

fail() {
    echo "setup: $1" >&2
    exit 1
}

command -v gcc >/dev/null || fail "gcc is missing; install it (Debian: apt-get install gcc libc6-dev)"
command -v python3 >/dev/null || fail "python3 is missing; install it (Debian: apt-get install python3 python3-venv)"
python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
    fail "$(python3 -V) is too old; put Python 3.11 or newer first in PATH"
python3 -c 'import ensurepip, venv' 2>/dev/null ||
    fail "Python's venv module is missing; install it (Debian: apt-get install python3-venv)"

command -v "${UGV_CHROMIUM:-chromium}" chromium-browser google-chrome >/dev/null ||
    echo "setup: no chromium found: the tests of the report's pages will be skipped (Debian: apt-get install chromium)"

stamp="$(python3 -V) $PWD $(sha256sum <"$requirements")"
if [[ "$(cat "$venv/stamp" 2>/dev/null)" == "$stamp" ]]; then
    echo "setup: $venv is up to date"
    exit 0
fi

echo "setup: installing $requirements into $venv (about 1.9 GB, a minute)"
rm -rf "$venv"
python3 -m venv "$venv"
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary=:all: -r "$requirements" ||
    fail "pip could not install $requirements (message above); check the network or pip's index settings, then run $0 again"

# bindgen (in fmi-sys) needs libclang and a compiler to ask for the C include folders: .cargo/config.toml names these two.
ln -s "$("$venv/bin/python" -c 'import clang, pathlib; print(pathlib.Path(clang.__file__).resolve().parent / "native")')" "$venv/libclang"
ln -s "$(command -v gcc)" "$venv/include-finder"

echo "$stamp" >"$venv/stamp"
echo "setup: done"
