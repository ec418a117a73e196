"""Reading and writing JSON; nothing is ever left half-written."""

import hashlib
import json
import os
import sys
from pathlib import Path
from typing import Any


def load(path: Path) -> dict | None:
    """A JSON file; None where it is missing or broken off."""
    try:
        return json.loads(path.read_text())
    except (FileNotFoundError, json.JSONDecodeError):
        return None


def write(path: Path, text: str) -> None:
    """Writes beside and renames."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    os.replace(part, path)


def save(path: Path, value: Any) -> None:
    """Writes JSON beside and renames."""
    write(path, json.dumps(value, indent=1, allow_nan=False) + "\n")


def make_folder(path: Path) -> None:
    """Makes a folder if it is not there, or ends the program and says why not."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        sys.exit(f"prove: --out {path} cannot be made ({error.strerror}); give a folder that can be written")


def fingerprint(path: Path) -> str:
    """Tells one build of the tool from another."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()[:16]
