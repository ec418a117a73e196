"""Looks at a report's page in a real browser, as a phone, a screen and a printer show it.

    python tests/python/page_check.py report.html [--pictures FOLDER]
"""

import argparse
import json
import os
import shutil
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

WIDTHS = (360, 800, 1400)  # px
SCHEMES = ("light", "dark")
PAPER = 718  # px, A4 within Chromium's margins
PATIENCE = 180.0  # s for a page; a busy machine needs 30 s

# Gives a list of what is wrong with the page as it is laid out now.
LOOK = """(() => {
const problems = [];
const say = (text) => { if (problems.length < 40) problems.push(text); };
const tell = (e) => `<${e.tagName.toLowerCase()} class="${e.getAttribute('class') ?? ''}"> ` +
    `"${(e.textContent ?? '').trim().slice(0, 40)}"`;
const SLACK = 0.75;
const root = document.documentElement;
const width = root.clientWidth;
if (root.scrollWidth > width) say(`the page is ${root.scrollWidth} px wide in ${width} px`);

// Within what may be scrolled sideways only that itself must fit.
const scrolls = (e) => ['auto', 'scroll'].includes(getComputedStyle(e).overflowX);
const within = (e, test) => e && (test(e) || within(e.parentElement, test));
for (const e of document.body.querySelectorAll('*')) {
  if (e.closest('svg') && e.tagName !== 'svg') continue;
  const box = e.getBoundingClientRect();
  if (box.width === 0 || within(e.parentElement, scrolls)) continue;
  if (box.left < -SLACK || box.right > width + SLACK)
    say(`${tell(e)} sticks out: ${box.left.toFixed(1)} .. ${box.right.toFixed(1)} of ${width} px`);
}

const DRAWN = '.line, .dots, .step, .points, .band, .bar';
const overlap = (a, b) =>
  Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 &&
  Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
for (const svg of document.querySelectorAll('svg')) {
  const name = svg.getAttribute('aria-label');
  const frame = svg.getBoundingClientRect();
  if (!(frame.width > 100 && frame.height > 40)) { say(`${name}: ${frame.width} by ${frame.height} px`); continue; }
  const outside = (box, slack) => box.left < frame.left - slack || box.right > frame.right + slack ||
    box.top < frame.top - slack || box.bottom > frame.bottom + slack;
  const shapes = [...svg.querySelectorAll(DRAWN)];
  const sizes = shapes.map((shape) => shape.getBBox());
  if (!sizes.some((box) => box.width > 0.5 || box.height > 0.5)) say(`${name}: nothing is drawn`);
  for (const shape of shapes) {
    // Boxes of paths do not have their strokes, which may reach over by half their width.
    if (outside(shape.getBoundingClientRect(), 1)) say(`${name}: ${tell(shape)} is drawn outside`);
  }
  if (/NaN|inf/i.test(svg.innerHTML)) say(`${name}: a number is none`);
  const texts = [...svg.querySelectorAll('text')].filter((text) => text.textContent.trim());
  if (texts.length < 3) say(`${name}: no axis`);
  const boxes = texts.map((text) => text.getBoundingClientRect());
  texts.forEach((text, index) => {
    const box = boxes[index];
    if (outside(box, 0.25)) say(`${name}: text "${text.textContent}" is cut off`);
    const size = parseFloat(getComputedStyle(text).fontSize) * frame.width / svg.viewBox.baseVal.width;
    if (size < 8.5) say(`${name}: text "${text.textContent}" is ${size.toFixed(1)} px high`);
    for (let k = index + 1; k < texts.length; ++k)
      if (overlap(box, boxes[k]))
        say(`${name}: texts "${text.textContent}" and "${texts[k].textContent}" overlap`);
  });
}

// Contrast of every text with what is behind it (WCAG 2, 1.4.3).
const channels = (colour) => colour.match(/[0-9.]+/g).map(Number);
const light = (colour) => {
  const [r, g, b] = channels(colour).slice(0, 3).map((v) => {
    v /= 255;
    return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const behind = (e) => {
  for (; e; e = e.parentElement) {
    const colour = getComputedStyle(e).backgroundColor;
    if ((channels(colour)[3] ?? 1) > 0.99) return colour;
  }
  return 'rgb(255, 255, 255)';
};
for (const e of document.body.querySelectorAll('*')) {
  const own = [...e.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.textContent.trim());
  if (!own || ['style', 'title'].includes(e.tagName.toLowerCase())) continue;
  const style = getComputedStyle(e);
  const ink = e.closest('svg') ? style.fill : style.color;
  const [a, b] = [light(ink), light(behind(e))];
  const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  if (contrast < 4.5) say(`${tell(e)}: contrast ${contrast.toFixed(2)}`);
}
return {problems, paper: light(getComputedStyle(document.body).backgroundColor)};
})()"""


def find_chromium() -> str | None:
    """The system's browser; UGV_CHROMIUM names another."""
    named = os.environ.get("UGV_CHROMIUM")
    names = [named] if named else ["chromium", "chromium-browser", "google-chrome"]
    return next(filter(None, map(shutil.which, names)), None)


@contextmanager
def limited(seconds: float, what: str) -> Iterator[None]:
    """Ends what takes longer. Needs the main thread of a system with POSIX signals; elsewhere there is no limit."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def end(*_: object) -> None:
        raise TimeoutError(f"{what} took longer than {seconds:.0f} s")

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def browser(executable: str) -> Iterator[Browser]:
    """A browser without a window."""
    with sync_playwright() as playwright:
        # Containers run as root, for whom Chromium has no sandbox; the pages are our own.
        opened = playwright.chromium.launch(
            executable_path=executable, args=["--no-sandbox"], timeout=1000 * PATIENCE)
        try:
            yield opened
        finally:
            opened.close()


def look(page: Page, where: str) -> tuple[list[str], float]:
    """What is wrong with the page as it is laid out, and how light its background is."""
    seen = page.evaluate(LOOK)
    return [f"{where}: {problem}" for problem in seen["problems"]], seen["paper"]


def check_page(opened: Browser, path: Path, pictures: Path | None = None) -> list[str]:
    """What is wrong with a page, at every width, light and dark, and on paper; pictures of it are
    written where a folder is given."""
    with limited(PATIENCE, path.name):
        return checked(opened, path, pictures)


def checked(opened: Browser, path: Path, pictures: Path | None) -> list[str]:
    """As `check_page`, without a limit of time."""
    problems: list[str] = []
    page = opened.new_page()
    page.on("console", lambda message: problems.append(f"console: {message.text}"))
    page.on("pageerror", lambda error: problems.append(f"script: {error}"))
    page.on("requestfailed", lambda request: problems.append(f"not loaded: {request.url}"))
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(path.resolve().as_uri())
    if not page.evaluate("document.querySelectorAll('svg').length"):
        problems.append("the page has no plot")
    # What is folded away must be well set, too.
    page.evaluate("document.querySelectorAll('details').forEach((e) => { e.open = true })")
    for scheme in SCHEMES:
        page.emulate_media(color_scheme=scheme)
        for width in WIDTHS:
            page.set_viewport_size({"width": width, "height": 900})
            found, paper = look(page, f"{width} px, {scheme}")
            problems += found
            if (paper > 0.5) != (scheme == "light"):
                problems.append(f"{scheme}: the background's lightness is {paper:.2f}")
            if pictures:
                picture = pictures / f"{path.stem}-{width}-{scheme}.png"
                page.screenshot(path=picture, full_page=True)
    page.evaluate("document.querySelectorAll('details').forEach((e) => { e.open = false })")
    page.emulate_media(media="print", color_scheme="dark")
    page.set_viewport_size({"width": PAPER, "height": 1000})
    found, paper = look(page, "paper")
    problems += found
    if paper < 0.8:
        problems.append(f"paper: the background's lightness is {paper:.2f}")
    folded = "[...document.querySelectorAll('details table')].filter((e) => !e.checkVisibility({"
    folded += "contentVisibilityAuto: true})).length"
    if page.evaluate(folded):
        problems.append("paper: what is folded away is not printed")
    printed = page.pdf(format="A4")
    if not printed.startswith(b"%PDF-") or b"/Type /Page" not in printed:
        problems.append("it cannot be printed")
    if pictures:
        (pictures / f"{path.stem}.pdf").write_bytes(printed)
    others = [url for url in asked if url != path.resolve().as_uri()]
    if others:
        problems.append(f"it loads {json.dumps(others)}")
    page.close()
    return problems


def main() -> int:
    """Checks the pages named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pages", nargs="+", type=Path)
    parser.add_argument("--pictures", type=Path, help="folder for screenshots and PDFs")
    arguments = parser.parse_args()
    if arguments.pictures:
        arguments.pictures.mkdir(parents=True, exist_ok=True)
    executable = find_chromium()
    if executable is None:
        print("page_check: no chromium found; install it or name one in UGV_CHROMIUM", file=sys.stderr)
        return 2
    wrong = 0
    with browser(executable) as opened:
        for path in arguments.pages:
            problems = check_page(opened, path, arguments.pictures)
            wrong += bool(problems)
            print(f"{path}: {len(problems)} problems" if problems else f"{path}: well")
            for problem in problems:
                print(f"  {problem}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
