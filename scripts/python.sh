#!/usr/bin/env bash
# Builds the wheel of the Python package into target/wheels, and installs it into target/venv for the tests.
# Users need no script: pip install .
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case ${1:-} in
'') ;;
-h | --help)
    sed -n '2,/^set/s/^# \{0,1\}//p' scripts/python.sh
    exit 0
    ;;
*)
    echo "python: no such option: $1" >&2
    exit 1
    ;;
esac

./scripts/setup.sh test
rm -rf target/wheels
target/venv/bin/python -m maturin build --locked --release --quiet --interpreter target/venv/bin/python --out target/wheels
target/venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --force-reinstall target/wheels/*.whl
