#!/usr/bin/env bash
# Builds the FMU's shared libraries and the tool, and leaves target/ugv.fmu (FMI 2.0) and
# target/ugv-fmi3.fmu (FMI 3.0), both with those libraries. The library needs about this machine's glibc.
# --portable links it by zig instead, for glibc 2.17 and newer: do that for an FMU that is handed on.
# --platforms LIST names the platforms, separated by commas (default: linux64); all stands for those that can
# be built on Linux: linux64,win64,aarch64-linux. With any other than linux64 all are portable.
# --output FILE.fmu names the FMU of FMI 2.0, and FILE-fmi3.fmu is then that of FMI 3.0. Both are replaced.
# UGV_FEATURES names features of the tool beside the default ones: those of the tests save compiling it twice.
# Other arguments are passed on to `ugv package` (--vehicle, --terrain ...).
set -euo pipefail
# A relative one is the caller's, as for cargo; build_fmu_library.sh works elsewhere.
[[ ${CARGO_TARGET_DIR:-/} == /* ]] || export CARGO_TARGET_DIR=$PWD/$CARGO_TARGET_DIR
here=$(dirname "${BASH_SOURCE[0]}")
target=${CARGO_TARGET_DIR:-$here/../target}

fail() {
    echo "package: $1" >&2
    exit 1
}

platforms=linux64 portable=
output=$target/ugv.fmu
arguments=()
while [[ $# -gt 0 ]]; do
    case $1 in
    --platforms)
        [[ $# -gt 1 ]] || fail "--platforms needs a list: linux64,win64,aarch64-linux, or all"
        platforms=$2
        shift
        ;;
    --platforms=*) platforms=${1#*=} ;;
    --portable) portable=--portable ;;
    --output | -o)
        output=${2:-}
        [[ $# -eq 1 ]] || shift
        ;;
    --output=*) output=${1#*=} ;;
    -o*)
        output=${1#-o}
        output=${output#=}
        ;;
    --fmi* | --merge*) fail "$1 is not for here, where the FMUs of FMI 2.0 and 3.0 are made; use target/release/ugv package" ;;
    *) arguments+=("$1") ;;
    esac
    shift
done
[[ -n $output ]] || fail "--output needs a file: mine.fmu"
[[ $platforms != all ]] || platforms=linux64,win64,aarch64-linux
libraries=()
others=()
for platform in ${platforms//,/ }; do
    case $platform in
    linux64) file=$target/fmu/ugv.so ;;
    aarch64-linux) file=$target/fmu/$platform/ugv.so ;;
    win64) file=$target/fmu/$platform/ugv.dll ;;
    darwin64) file=$target/fmu/$platform/ugv.dylib ;;
    *) fail "no such platform: $platform; there are linux64, win64, aarch64-linux and, on a Mac, darwin64" ;;
    esac
    libraries+=(--library "$platform=$file")
    case $platform in aarch64-linux | win64) others+=("$platform") ;; esac
done
[[ ${#libraries[@]} -gt 0 ]] || fail "--platforms names none"

[[ $platforms == linux64 ]] || portable=--portable
"$here/setup.sh" ${portable:+platforms}
[[ ${#others[@]} -eq 0 ]] || "$here/tools/setup_platforms.sh" "${others[@]}"
# The library is optimised as a whole, on one core; the tool is compiled on the others meanwhile.
for platform in ${platforms//,/ }; do
    "$here/tools/build_fmu_library.sh" "$platform" $portable
done &
libraries_built=$!
cargo build --manifest-path "$here/../Cargo.toml" --locked --release --quiet ${UGV_FEATURES:+--features "$UGV_FEATURES"} || {
    kill "$libraries_built" 2>/dev/null
    fail "the tool could not be built (message above)"
}
wait "$libraries_built"
package=("$target/release/ugv" package --force "${libraries[@]}")
"${package[@]}" "${arguments[@]+"${arguments[@]}"}" --fmi 3 --output "${output%.fmu}-fmi3.fmu"
"${package[@]}" "${arguments[@]+"${arguments[@]}"}" --output "$output"
