#!/usr/bin/env bash
# Sets up what is missing, builds, and runs the tests: test.sh [--quick | --all]
#
#   --quick    unit tests, the model against paper, limits and golden values, the tool (three minutes once built, on two cores)
#   (default)  these; recordings, fits, diagnoses and reports on drives of known truth; the FMU from C and through
#              fmpy; the Python scripts (10 minutes once built, 22 from a fresh clone, on two idle cores)
#   --all      for every night, several hours: also what is marked nightly, which is
#              - the fits and searches that take minutes
#              - 2000 random drives of each kind (tests/model/drivable)
#              - 24 sealed cases of the independent generator through scripts/prove.sh
#              - the FMU for old glibc, for win64 under wine and for aarch64-linux under qemu, built twice
#              - eleven importers; a soak of ten million steps; a fuzzing campaign, if cargo-fuzz is there
#
# Nightly tests bear #[ignore = "nightly: why"] in Rust and @pytest.mark.nightly in Python.
# A test that cannot run here (no data in UGV_DATA, no chromium) is skipped, and is not counted as passed.
set -euo pipefail
caller=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/.."
target=${CARGO_TARGET_DIR:-target}

tier=default
case ${1:-} in
--quick | --all) tier=${1#--} ;;
-h | --help)
    sed -n '2,/^set/s/^# \{0,1\}//p' scripts/test.sh
    exit 0
    ;;
'') ;;
*)
    echo "test: no such option: $1; there are --quick and --all" >&2
    exit 1
    ;;
esac
# The other scripts build with the features of the tests: nothing is compiled twice.
export UGV_FEATURES=fmu
[[ -z ${UGV_DATA:-} || $UGV_DATA == /* ]] || export UGV_DATA=$caller/$UGV_DATA

# A failure does not keep what comes after it from being run.
status=0 summary=()
cargo_test=(cargo test --locked --release --features fmu --no-fail-fast)
targets=(--lib --bins --tests)
harness=()
groups=(demo proof scale test)
package=()
python=(-m "not nightly")
case $tier in
quick)
    targets=(--lib --bins --test architecture --test model --test cli)
    groups=()
    ;;
all)
    groups+=(platforms)
    package=(--platforms all)
    harness=(--include-ignored)
    python=()
    ;;
esac

./scripts/setup.sh ${groups[@]+"${groups[@]}"}
mkdir -p "$target/test"
if [[ $tier != quick ]]; then
    # The FMU is linked on one core, while the tests are compiled on the others.
    ./scripts/package.sh ${package[@]+"${package[@]}"} >"$target/test/package.log" 2>&1 &
    packaging=$!
fi
"${cargo_test[@]}" "${targets[@]}" --no-run || status=1
[[ $tier != all ]] || cargo build --locked --release --features fmu --examples || status=1
if [[ $tier != quick ]]; then
    wait "$packaging" || {
        cat "$target/test/package.log" >&2
        echo "test: scripts/package.sh failed (above)" >&2
        exit 1
    }
fi

echo "test: Rust"
log=$target/test/rust.log
# With one thread the harness does not name the thread after the test, and a skipped test would not say its name.
threads=$(nproc)
export RUST_TEST_THREADS=${RUST_TEST_THREADS:-$((threads > 1 ? threads : 2))}
"${cargo_test[@]}" "${targets[@]}" -- ${harness[@]+"${harness[@]}"} 2>&1 | tee "$log" || status=1
if [[ $tier != quick ]]; then
    "${cargo_test[@]}" --doc 2>&1 | tee -a "$log" || status=1
fi
skipped=$(sed -n 's/^skipped: \([^ ]*\): .*/\1/p' "$log" | sort -u | wc -l)
summary+=("$(awk -v skipped="$skipped" '
    /^test result:/ { passed += $4; failed += $6; nightly += $8 }
    END { printf "Rust: %d passed, %d failed, %d skipped, %d for --all", passed - skipped, failed, skipped, nightly }' "$log")")

if [[ $tier != quick ]]; then
    ./scripts/python.sh || status=1
    echo "test: Python"
    log=$target/test/python.log
    # A module on each of two cores; those that skip say why.
    target/venv/bin/python -m pytest tests/python ${python[@]+"${python[@]}"} --numprocesses 2 --dist loadfile \
        --no-loadscope-reorder -p no:cacheprovider -q -rs --durations 12 2>&1 | tee "$log" || status=1
    summary+=("Python: $(tail -n 1 "$log" | sed 's/^=* *//; s/ *=*$//')")
fi

# campaign NAME COMMAND... : runs it and notes how it ended.
campaign() {
    local name=$1 result=passed
    shift
    echo "test: $name"
    "$@" || result=failed status=1
    summary+=("$name: $result")
}
if [[ $tier == all ]]; then
    campaign "Same bytes twice" ./scripts/tools/reproduce.sh linux64 win64 aarch64-linux
    campaign Importers ./scripts/tools/importers.sh
    campaign Soak ./scripts/tools/soak.sh --steps 10000000 --instances 10000
    if cargo fuzz --version >/dev/null 2>&1; then
        campaign Fuzzing ./scripts/tools/fuzz.sh
    else
        summary+=("Fuzzing: skipped, cargo-fuzz is not installed")
    fi
fi

echo
sed -n 's/^skipped: /skipped: /p' "$target/test/rust.log" | sort -u
printf '%s\n' "${summary[@]}"
exit $status
