#!/usr/bin/env bash
# Builds the FMU's shared library for a platform and checks it: build_fmu_library.sh [PLATFORM] [--portable]
# It has the functions of FMI 2.0 and of FMI 3.0, so that one library serves the FMUs of both.
#   linux64 (default)  target/fmu/ugv.so                linked by gcc: needs about this machine's glibc;
#                                                       with --portable by zig: runs on glibc 2.17 and newer
#   aarch64-linux      target/fmu/aarch64-linux/ugv.so  runs on glibc 2.17 and newer
#   win64              target/fmu/win64/ugv.dll         runs on Windows 7 and newer
#   darwin64           target/fmu/darwin64/ugv.dylib    x86 and ARM in one; built on a Mac only
# The same source gives the same bytes wherever it is checked out.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

venv=$PWD/target/venv
target=${CARGO_TARGET_DIR:-target}
oldest_glibc=2.17

fail() {
    echo "build_fmu_library: $1" >&2
    exit 1
}

[[ ${BASH_VERSINFO[0]} -ge 4 ]] ||
    fail "bash $BASH_VERSION is too old; install bash 4 or newer (macOS: brew install bash) and have it first in PATH"
# Where HOME is not set, bash looks it up; nothing where it is /.
home=~
home=${home%/}

platform=linux64 linker=gcc
for argument; do
    case $argument in
    linux64) ;;
    aarch64-linux | win64 | darwin64) platform=$argument ;;
    --portable) linker=zig ;;
    *) fail "no such platform: $argument; there are linux64, aarch64-linux, win64 and darwin64" ;;
    esac
done
[[ $platform != aarch64-linux ]] || linker=zig
[[ -f $venv/stamp ]] || fail "the Python tools are missing; run scripts/setup.sh first"
[[ $linker != zig || -x $venv/bin/python-zig ]] || fail "zig is missing; run scripts/setup.sh platforms first"

case $platform in
linux64) checked=$target/fmu/ugv.so ;;
aarch64-linux) checked=$target/fmu/$platform/ugv.so ;;
win64) checked=$target/fmu/$platform/ugv.dll ;;
darwin64) checked=$target/fmu/$platform/ugv.dylib ;;
esac
library=$checked.unchecked
exports=$target/fmu/exports.$platform
mkdir -p "$target/fmu" "$(dirname "$checked")"
rm -f "$checked"

# Every function of the standard's headers is visible, and nothing else.
mapfile -t headers < <(find "$venv"/lib/ -path '*/fmpy/c-code/fmi[23]Functions.h')
functions=$(sed -nE 's/^ *FMI[23]_Export +fmi[23][A-Za-z0-9]+TYPE +(fmi[23][A-Za-z0-9]+);.*/\1/p' "${headers[@]}" | LC_ALL=C sort)

# 1. The Rust side: an archive without any glibc version in it. Absolute paths would end up in panic messages.
separator=$'\x1f'
sources=
rust() {
    local flags="--remap-path-prefix=${CARGO_HOME:-$home/.cargo}=/cargo${separator}--remap-path-prefix=$PWD=/ugv_terrain"
    [[ -z $sources ]] || flags+="${separator}--remap-path-prefix=$sources=/rust"
    CARGO_ENCODED_RUSTFLAGS=$flags \
        "${cargo:-cargo}" rustc --locked --lib --crate-type staticlib --profile fmu --no-default-features --features fmu "$@"
}

# rust_for TRIPLE COMPILER: the same for another platform, for which the standard library is compiled as well.
rust_for() {
    [[ -x target/cross/rustc ]] || fail "the Rust for $platform is missing; run scripts/tools/setup_platforms.sh $platform first"
    cargo=target/cross/cargo
    export RUSTC=$PWD/target/cross/rustc RUSTC_BOOTSTRAP=1
    sources=$("$RUSTC" --print sysroot)/lib/rustlib/src/rust
    # fmi-sys compiles a C file, and reads the standard's header, for which zig's clang has the headers of C.
    export "CC_${1//-/_}=$2-gcc" "AR_${1//-/_}=$2-ar"
    headers=$(dirname "$(find "$venv"/lib/ -path '*/ziglang/lib/include/stddef.h')")
    export BINDGEN_EXTRA_CLANG_ARGS="-isystem '$headers'"
    rust -Zbuild-std=std,panic_unwind --target "$1"
    archive=$target/$1/fmu/libugv_terrain.a
}

# 2. The shared library: unused code is dropped (-u pulls the one object that the functions are all in).
elf() {
    printf '{ global: %s; local: *; };\n' "${functions//$'\n'/; }" >"$exports"
    "$@" -shared -o "$library" -Wl,-u,fmi2GetVersion -Wl,-u,fmi3GetVersion "$archive" \
        -Wl,--version-script="$exports" -Wl,-Bsymbolic -Wl,--gc-sections -Wl,-z,defs -Wl,--build-id=none -Wl,-s "${libraries[@]}"
}

zig_elf() {
    export ZIG_GLOBAL_CACHE_DIR=$PWD/target/zig-cache ZIG_LOCAL_CACHE_DIR=$PWD/target/zig-cache
    libraries=(-lunwind)
    elf "$venv/bin/python-zig" cc -target "$1-linux-gnu.$oldest_glibc"
}

dll() {
    printf 'EXPORTS\n%s\n' "$functions" >"$exports.def"
    x86_64-w64-mingw32-gcc -shared -o "$library" "$exports.def" -Wl,-u,fmi2GetVersion -Wl,-u,fmi3GetVersion "$archive" \
        -Wl,--gc-sections -Wl,--no-insert-timestamp -Wl,-s -static-libgcc -lntdll
}

dylib() {
    export MACOSX_DEPLOYMENT_TARGET=11.0
    printf '_%s\n' "${functions//$'\n'/$'\n'_}" >"$exports"
    local triple architectures=()
    for triple in x86_64 aarch64; do
        rust --target "$triple-apple-darwin"
        cc -dynamiclib -arch "${triple/aarch64/arm64}" -o "$library.$triple" -Wl,-u,_fmi2GetVersion -Wl,-u,_fmi3GetVersion \
            "$target/$triple-apple-darwin/fmu/libugv_terrain.a" -Wl,-exported_symbols_list,"$exports" \
            -Wl,-install_name,@rpath/ugv.dylib -Wl,-dead_strip -Wl,-x
        architectures+=("$library.$triple")
    done
    lipo -create -output "$library" "${architectures[@]}"
    rm "${architectures[@]}"
}

# Which symbols it exports, and which libraries it needs of which all hosts have those.
elf_symbols() { nm -D --defined-only "$library" | awk '{print $3}'; }
elf_needed() { objdump -p "$library" | awk '$1 == "NEEDED" {print $2}'; }
dll_symbols() { x86_64-w64-mingw32-objdump -p "$library" | sed -n '/^\[Ordinal\/Name Pointer\]/,/^$/s/^\t.*\] //p'; }
dll_needed() { x86_64-w64-mingw32-objdump -p "$library" | awk '/DLL Name:/ {print tolower($3)}' | sort -u; }
dylib_symbols() { nm -arch all -gUj "$library" | sed -n 's/^_//p' | sort -u; }
dylib_needed() { otool -arch all -L "$library" | awk '/^\t/ && !/@rpath\/ugv.dylib/ {print $1}' | sort -u; }

case $platform in
linux64)
    format=elf everywhere='(libc|libm|libdl|libpthread|librt|ld-linux-x86-64)\.so\.[0-9]+'
    rust
    archive=$target/fmu/libugv_terrain.a
    libraries=(-static-libgcc -lm -lpthread -ldl)
    if [[ $linker == gcc ]]; then elf gcc; else zig_elf x86_64; fi
    ;;
aarch64-linux)
    format=elf everywhere='(libc|libm|libdl|libpthread|librt|ld-linux-aarch64)\.so\.[0-9]+'
    rust_for aarch64-unknown-linux-gnu aarch64-linux-gnu
    zig_elf aarch64
    ;;
win64)
    # The target for Windows 7 asks the system for random numbers in a way that wine knows as well.
    format=dll everywhere='(kernel32|msvcrt|ntdll)\.dll'
    rust_for x86_64-win7-windows-gnu x86_64-w64-mingw32
    dll
    ;;
darwin64)
    format=dylib everywhere='/usr/lib/.*|/System/Library/.*'
    [[ $(uname) == Darwin ]] || fail "darwin64 is built on a Mac only; there, first: rustup target add x86_64-apple-darwin aarch64-apple-darwin"
    dylib
    ;;
esac

# 3. Checks: the symbols; old glibc; the system's own libraries only; no path of this machine.
diff <(echo "$functions") <("${format}_symbols" | LC_ALL=C sort) ||
    fail "$library does not export exactly the FMI functions (< missing, > too much)"

needs="the system's libraries"
if [[ $format == elf ]]; then
    needs=$(objdump -T "$library" | grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -n 1)
    if [[ $linker == zig && "$(printf '%s\n' "$needs" "GLIBC_$oldest_glibc" | sort -V | tail -n 1)" != "GLIBC_$oldest_glibc" ]]; then
        fail "$library needs $needs, newer than $oldest_glibc: see objdump -T"
    fi
fi

strange=$("${format}_needed" | grep -vxE "$everywhere" || true)
[[ -z $strange ]] || fail "$library needs a library a host may not have: $strange"

paths=(-e "$PWD")
[[ -z $home ]] || paths+=(-e "$home/")
[[ -z $sources ]] || paths+=(-e "$sources")
! grep -qaF "${paths[@]}" "$library" || fail "$library contains a path of this machine: see strings"

mv "$library" "$checked"
echo "build_fmu_library: $checked, $(wc -c <"$checked" | tr -d ' ') bytes, needs $needs"
sha256sum "$checked"
