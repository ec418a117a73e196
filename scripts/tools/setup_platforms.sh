#!/usr/bin/env bash
# Sets up what building the FMU's library for other platforms needs: setup_platforms.sh PLATFORM...
# A Rust with the standard library's sources (it is compiled anew for them), and for each platform a
# C compiler. As root on Debian it installs what is missing; otherwise it says what and how.
# Leaves target/cross/rustc and target/cross/cargo, links to that Rust.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

fail() {
    echo "setup_platforms: $1" >&2
    exit 1
}

# install WHAT PACKAGE... : by apt-get where that is possible. Its lists are fetched anew once: old ones name
# packages that are gone, or a Rust that is too old.
lists=old
install() {
    local what=$1
    shift
    if ! command -v apt-get >/dev/null || [[ $(id -u) != 0 ]]; then
        return 1
    fi
    if [[ $lists == old ]]; then
        apt-get update --quiet=2 >/dev/null || echo "setup_platforms: apt-get update failed (message above); going on with the lists as they are" >&2
        lists=new
    fi
    echo "setup_platforms: installing $what ($*)"
    DEBIAN_FRONTEND=noninteractive DEBCONF_NOWARNINGS=yes apt-get install --quiet=2 --yes --no-install-recommends "$@" >/dev/null
}

wanted=$(sed -nE 's/^rust-version = "(.*)"$/\1/p' Cargo.toml)

# The first Rust that is new enough and brings the sources along: the one in PATH, or Debian's.
find_rust() {
    local rustc sysroot version
    for rustc in "$(command -v rustc || true)" /usr/bin/rustc; do
        [[ -n $rustc && -x $rustc && -x ${rustc%rustc}cargo ]] || continue
        sysroot=$("$rustc" --print sysroot) || continue
        version=$("$rustc" --version | cut -d ' ' -f 2)
        [[ -f $sysroot/lib/rustlib/src/rust/library/Cargo.lock ]] || continue
        [[ $(printf '%s\n' "$wanted" "$version" | sort -V | head -n 1) == "$wanted" ]] || continue
        echo "$rustc"
        return
    done
    return 1
}

# compiler PLATFORM PROGRAM PACKAGE...
compiler() {
    local platform=$1 program=$2
    shift 2
    command -v "$program" >/dev/null || install "a C compiler for $platform" "$@" ||
        fail "$platform needs $program; install it (Debian: apt-get install $*)"
}

[[ $# -gt 0 ]] || fail "name the platforms: win64, aarch64-linux"
for platform; do
    case $platform in
    win64) compiler win64 x86_64-w64-mingw32-gcc gcc-mingw-w64-x86-64-win32 ;;
    aarch64-linux) compiler aarch64-linux aarch64-linux-gnu-gcc gcc-aarch64-linux-gnu libc6-dev-arm64-cross ;;
    *) fail "$platform is not built from here; win64 and aarch64-linux are" ;;
    esac
done

if ! rustc=$(find_rust); then
    sources=(rustc-web cargo-web rust-web-src)
    remedy="rustup component add rust-src; or, on Debian 12 with its security updates: apt-get install ${sources[*]}"
    install "Debian's Rust with the sources of its standard library" "${sources[@]}" ||
        fail "no Rust that has the sources of its standard library; install them ($remedy)"
    rustc=$(find_rust) || fail "$(/usr/bin/rustc --version) is older than $wanted; install a newer one ($remedy)"
fi
mkdir -p target/cross
ln -sfn "$rustc" target/cross/rustc
ln -sfn "${rustc%rustc}cargo" target/cross/cargo
echo "setup_platforms: $(target/cross/rustc --version), for $*"
