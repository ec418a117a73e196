#!/usr/bin/env bash
# Builds the book, docs/, as a website in target/book. A warning of mdBook is an error.
# The first time it installs mdBook into target/tools.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

version=0.5.2
mdbook=target/tools/bin/mdbook
if [[ "$("$mdbook" --version 2>/dev/null)" != "mdbook v$version" ]]; then
    cargo install mdbook --version "$version" --locked --no-default-features --root target/tools
fi
rm -rf target/book
log=$("$mdbook" build docs 2>&1) || {
    echo "$log" >&2
    exit 1
}
echo "$log"
if grep -qE '^ *(WARN|ERROR)|\[(WARN|ERROR)\]' <<<"$log"; then
    echo "book: mdBook warns (above); put it right in docs/" >&2
    exit 1
fi
echo "book: target/book/index.html"
