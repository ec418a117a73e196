#!/usr/bin/env bash
# Builds the FMU's libraries once more, from a copy of the source in another folder, and compares them byte for
# byte with those in target/fmu, which are portable: reproduce.sh [PLATFORM...] (default: linux64). Takes a few
# minutes for each.
set -euo pipefail
shopt -s extglob nullglob
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

fail() {
    echo "reproduce: $1" >&2
    exit 1
}

[[ $# -gt 0 ]] || set -- linux64
here=$PWD
first=${CARGO_TARGET_DIR:-$here/target}/fmu
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT

# The tools are the same, everything that is built is not.
tar --create --exclude=./target --exclude=./.git . | tar --extract --directory "$copy"
mkdir "$copy/target"
for tools in venv cross; do
    [[ ! -e target/$tools ]] || ln -s "$here/target/$tools" "$copy/target/$tools"
done

for platform; do
    folder=$platform
    [[ $platform != linux64 ]] || folder=.
    libraries=("$first/$folder"/ugv.@(so|dll|dylib))
    [[ ${#libraries[@]} == 1 ]] || fail "there is no library for $platform in $first; build it with scripts/tools/build_fmu_library.sh $platform --portable"
    env --unset=CARGO_TARGET_DIR "$copy/scripts/tools/build_fmu_library.sh" "$platform" --portable
    again=$copy/target/fmu/$folder/$(basename "${libraries[0]}")
    cmp "${libraries[0]}" "$again" ||
        fail "$platform: the same source gave other bytes in another folder (or ${libraries[0]} is of another source, or not portable)"
    echo "reproduce: $platform is the same to the byte: $(sha256sum <"$again" | cut -d ' ' -f 1)"
done
