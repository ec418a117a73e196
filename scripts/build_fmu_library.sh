#!/usr/bin/env bash
# Builds the FMU's shared library, target/fmu/ugv.so (linux64), and checks it. It has the functions of
# FMI 2.0 and of FMI 3.0, so that one library serves the FMUs of both.
# It runs on glibc 2.17 and newer; with --native it is linked by gcc and needs about this machine's glibc.
# The same source gives the same bytes wherever it is checked out.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

venv=$PWD/target/venv
target=${CARGO_TARGET_DIR:-target}
checked=$target/fmu/ugv.so
library=$checked.unchecked
oldest_glibc=2.17

fail() {
    echo "build_fmu_library: $1" >&2
    exit 1
}

[[ -f $venv/stamp ]] || fail "the Python tools are missing; run scripts/setup.sh first"

rm -f "$checked"

# 1. The Rust side: an archive without any glibc version in it. Absolute paths would end up in panic messages.
separator=$'\x1f'
CARGO_ENCODED_RUSTFLAGS="--remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=/cargo${separator}--remap-path-prefix=$PWD=/ugv_terrain" \
    cargo rustc --locked --lib --crate-type staticlib --profile fmu --no-default-features --features fmu

# 2. The shared library: only the FMI functions are visible, unused code is dropped (-u pulls the one object they are all in).
exports=$target/fmu/exports.map
echo '{ global: fmi2*; fmi3*; local: *; };' >"$exports"
link=(-shared -o "$library" -Wl,-u,fmi2GetVersion -Wl,-u,fmi3GetVersion "$target/fmu/libugv_terrain.a"
    -Wl,--version-script="$exports" -Wl,-Bsymbolic -Wl,--gc-sections -Wl,-z,defs -Wl,--build-id=none -Wl,-s)
if [[ ${1:-} == --native ]]; then
    gcc "${link[@]}" -static-libgcc -lm -lpthread -ldl
else
    export ZIG_GLOBAL_CACHE_DIR=$PWD/target/zig-cache ZIG_LOCAL_CACHE_DIR=$PWD/target/zig-cache
    "$venv/bin/python-zig" cc -target "x86_64-linux-gnu.$oldest_glibc" "${link[@]}" -lunwind
fi

# 3. Checks: every function of the standard's headers and nothing else; old glibc; glibc's own libraries only; no path of this machine.
mapfile -t headers < <(find "$venv"/lib/ -path '*/fmpy/c-code/fmi[23]Functions.h')
diff <(sed -nE 's/^ *FMI[23]_Export +fmi[23]\w+TYPE +(fmi[23]\w+);.*/\1/p' "${headers[@]}" | LC_ALL=C sort) \
    <(nm -D --defined-only "$library" | awk '{print $3}' | LC_ALL=C sort) ||
    fail "$library does not export exactly the FMI functions (< missing, > too much)"

newest=$(objdump -T "$library" | grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -n 1)
if [[ ${1:-} != --native && "$(printf '%s\n' "$newest" "GLIBC_$oldest_glibc" | sort -V | tail -n 1)" != "GLIBC_$oldest_glibc" ]]; then
    fail "$library needs $newest, newer than $oldest_glibc: see objdump -T"
fi

needed=$(objdump -p "$library" | awk '$1 == "NEEDED" {print $2}')
strange=$(grep -vE '^(libc|libm|libdl|libpthread|librt|ld-linux-x86-64)\.so\.[0-9]+$' <<<"$needed" || true)
[[ -z $strange ]] || fail "$library needs a library a host may not have: $strange"

! grep -qaF -e "$PWD" -e "$HOME/" "$library" || fail "$library contains a path of this machine: see strings"

mv "$library" "$checked"
echo "build_fmu_library: $checked, $(stat -c %s "$checked") bytes, needs $newest"
sha256sum "$checked"
