"""README and book: links, anchors, pictures and paths exist, every page is in the summary, and marked code blocks run.

`<!-- runs -->` on the line before a fenced `sh` or `python` block has it run, `<!-- runs nightly -->` with `-m nightly` alone. The blocks
of a page run in order in one scratch folder, in which `target` and `scripts` are the repository's and `ugv` is on the PATH.
"""

import os
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = sorted([*ROOT.glob("*.md"), *DOCS.rglob("*.md")])
BUILT = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PYTHON = ROOT / "target/venv/bin"
FENCE = re.compile(r"^```(\w*)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
RUNS = re.compile(r"^<!-- runs( nightly)? -->\n```(sh|python)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
CODE_SPAN = re.compile(r"`[^`\n]+`")
PATH = re.compile(r"(?<![\w/.-])(?:\./)?((?:scripts|tests|src|docs|modelDescription|\.github)/[\w./-]*\w)")
LIMIT_S = {False: 600, True: 3600}  # of a block, by day and at night: against a hang alone


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


def prose(page: Path) -> str:
    """The page without code blocks and code spans."""
    return CODE_SPAN.sub("", FENCE.sub("", page.read_text()))


def anchors(page: Path) -> set[str]:
    """As GitHub and mdBook make them of headings."""
    headings = re.findall(r"^#+ (.+)$", FENCE.sub("", page.read_text()), re.MULTILINE)
    plain = (re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading) for heading in headings)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in plain}


def links(page: Path) -> list[str]:
    return [link for link in LINK.findall(prose(page)) if not re.match(r"[a-z]+:", link)]


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_lead_somewhere(page: Path) -> None:
    for link in links(page):
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), f"{name(page)}: no file {link}"
        if anchor:
            assert anchor in anchors(target), f"{name(page)}: no heading for {link}"
        if page.is_relative_to(DOCS):
            assert target.is_relative_to(DOCS), f"{name(page)}: {link} leaves the book; write the path as code"


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_paths_of_the_repository_exist(page: Path) -> None:
    missing = [path for path in PATH.findall(page.read_text()) if not (ROOT / path).exists()]
    assert not missing, f"{name(page)}: {missing}"


def test_the_summary_lists_every_page_once() -> None:
    listed = [DOCS / link for link in LINK.findall((DOCS / "SUMMARY.md").read_text())]
    assert sorted(listed) == [page for page in sorted(DOCS.rglob("*.md")) if page.name != "SUMMARY.md"]


def test_every_picture_is_shown() -> None:
    shown = {(page.parent / link).resolve() for page in PAGES for link in links(page)}
    pictures = {file for file in DOCS.rglob("*") if file.suffix in (".png", ".svg")}
    assert pictures <= shown, sorted(map(str, pictures - shown))


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text().split()) <= 1500


def marked(nightly: bool) -> list[Path]:
    return [page for page in PAGES if any(bool(found[0]) == nightly for found in RUNS.findall(page.read_text()))]


def run_blocks(page: Path, folder: Path, nightly: bool) -> None:
    """Each block in a shell or a Python that stops at the first error."""
    for needed in (BUILT / "release/ugv", BUILT / "fmu/ugv.so", BUILT / "ugv.fmu", PYTHON / "python"):
        if not needed.exists():
            pytest.skip(f"there is no {needed}; scripts/package.sh makes it")
    (folder / "target").symlink_to(ROOT / "target")
    (folder / "scripts").symlink_to(ROOT / "scripts")
    # Scripts find the repository through the link (`physical`: cd resolves it).
    paths = [str(BUILT / "release"), str(PYTHON), os.environ["PATH"]]
    environment = {**os.environ, "PATH": os.pathsep.join(paths), "SHELLOPTS": "physical"}
    for at_night, language, code in RUNS.findall(page.read_text()):
        if bool(at_night) != nightly:
            continue
        command = ["bash", "-euo", "pipefail", "-c", code] if language == "sh" else [PYTHON / "python", "-c", code]
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=LIMIT_S[nightly], check=False)
        assert done.returncode == 0, f"{name(page)}:\n{code}\n{done.stdout}\n{done.stderr}"


@pytest.mark.parametrize("page", marked(nightly=False), ids=name)
def test_blocks_run(page: Path, tmp_path: Path) -> None:
    run_blocks(page, tmp_path, nightly=False)


@pytest.mark.nightly
@pytest.mark.parametrize("page", marked(nightly=True), ids=name)
def test_long_blocks_run(page: Path, tmp_path: Path) -> None:
    run_blocks(page, tmp_path, nightly=True)
