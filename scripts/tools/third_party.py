#!/usr/bin/env python3
"""Writes modelDescription/third_party.txt: the licences of what is linked into the FMU's shared library, which every FMU carries.

With --check it writes nothing and fails where the file is out of date.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = ROOT / "modelDescription" / "third_party.txt"
FEATURES = ["--locked", "--no-default-features", "--features", "fmu"]
OWN = "ugv-terrain"
HEAD = """The shared libraries in binaries/ hold the crates below and parts of the Rust standard library (MIT OR Apache-2.0,
https://github.com/rust-lang/rust). Of crates that offer several licences, MIT is taken.
"""
APACHE = "Apache License 2.0, as in LICENSE-APACHE.txt beside this file."


def cargo(*words: str) -> str:
    """What cargo says of the lock file's crates."""
    return subprocess.run(["cargo", *words, *FEATURES], cwd=ROOT, check=True, capture_output=True, text=True).stdout


def linked() -> list[dict]:
    """The packages that are linked on any platform, by name; macros and what builds are not."""
    told = cargo("tree", "--target", "all", "--edges", "normal,no-proc-macro", "--prefix", "none", "--format", "{p}")
    names = {tuple(line.split()[:2]) for line in told.splitlines() if line}
    packages = json.loads(cargo("metadata", "--format-version", "1"))["packages"]
    found = [package for package in packages if (package["name"], f"v{package['version']}") in names and package["name"] != OWN]
    return sorted(found, key=lambda package: package["name"])


def terms(package: dict) -> str:
    """The text of a package's licence."""
    folder = Path(package["manifest_path"]).parent
    files = {path.stem.upper() if path.suffix in (".md", ".txt") else path.name.upper(): path for path in sorted(folder.iterdir())}
    chosen = files.get("LICENSE-MIT") if "MIT" in package["license"] else None
    chosen = chosen or files.get("LICENSE") or files.get("COPYING")
    if chosen is None:
        return f"{package['license']}; the crate has no licence text. Its authors: {', '.join(package['authors']) or 'not named'}."
    text = chosen.read_text(encoding="utf-8").strip()
    notice = files.get("NOTICE")
    if package["license"] == "Apache-2.0" and "TERMS AND CONDITIONS FOR USE, REPRODUCTION, AND DISTRIBUTION" in text:
        text = APACHE
    return "\n\n".join([text, *([notice.read_text(encoding="utf-8").strip()] if notice else [])])


def written() -> str:
    """The whole file."""
    parts = [HEAD]
    for package in linked():
        title = f"{package['name']} {package['version']} ({package['license']})"
        parts.append(f"{title}\n{package['repository'] or ''}".rstrip() + f"\n\n{terms(package)}\n")
    lines = ("\n" + "-" * 80 + "\n\n").join(parts).splitlines()
    return "\n".join(line.rstrip() for line in lines) + "\n"


def main() -> None:
    """Reads the arguments, writes or compares."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="write nothing; fail where the file is out of date")
    check = parser.parse_args().check
    try:
        text = written()
    except subprocess.CalledProcessError as error:
        sys.exit(f"third_party: {error.stderr.strip()}")
    if check:
        if not TARGET.is_file() or TARGET.read_text(encoding="utf-8") != text:
            sys.exit(f"third_party: {TARGET.relative_to(ROOT)} is out of date; run scripts/tools/third_party.py")
        return
    part = TARGET.with_name(TARGET.name + ".part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, TARGET)


if __name__ == "__main__":
    main()
