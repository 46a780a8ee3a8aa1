# SPDX-License-Identifier: Apache-2.0
"""Takes the pictures of docs/results.md: reports of `slipwise calibrate` on real logs, in Chromium."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from slipwise.cli.main import run
from slipwise.files import write_whole

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
WIDTH, TALLEST = 860, 3000  # [px]
COLOURS, LARGEST = 160, 150_000  # of a picture's palette; [bytes]
HEAD = "Does the learned model help?"
#: Hides all of a report but one section; the page allows styles, and no script but its own.
ALONE = """<style>
section[id], details.section, details:not(.section), button {{ display: none !important; }}
#{section}[id] {{ display: block !important; }}
</style>"""


@dataclass(frozen=True)
class Shown:
    """A report, and what is shown of it: a picture's name for each section's heading."""

    log: str
    options: tuple[str, ...]
    code: int
    pictures: dict[str, str]


PATHS, TRUTH = "Where the robot drove, and what was predicted", "Is the reported uncertainty true?"
COMMANDS, WHEELS = ("--input", "command"), ("--input", "wheel")
REPORTS = (
    Shown(
        "husky/tile_deflated_tyres",
        COMMANDS,
        0,
        {"gallery-husky.png": HEAD, "gallery-husky-paths.png": PATHS},
    ),
    Shown("warthog/grass_7_29_14h46s15", WHEELS, 0, {"gallery-warthog.png": HEAD}),
    Shown(
        "robotino/table_gray",
        COMMANDS,
        0,
        {"gallery-robotino.png": HEAD, "gallery-robotino-truth.png": TRUTH},
    ),
    Shown("f1tenth/DS5", (*COMMANDS, "--end", "40"), 1, {"gallery-f1tenth.png": HEAD}),
)


def find_browser() -> str:
    """Return the path of a Chromium."""
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    if found is None:
        sys.exit("no Chromium: install one of " + ", ".join(BROWSERS))
    return found


def alone(report: str, title: str) -> str:
    """Return a report that shows one section, unfolded."""
    number = re.search(rf'id="(section-\d+)">(?:<summary>)?<h2>{re.escape(title)}</h2>', report)
    assert number is not None, title
    folded = f'<details class="section" id="{number[1]}"'
    style = ALONE.format(section=number[1])
    return report.replace(folded, f"{folded} open").replace("</head>", f"{style}</head>")


def photograph(browser: str, page: Path, picture: Path) -> None:
    """Write what a page shows as a PNG."""
    flags = (
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--hide-scrollbars",
        "--virtual-time-budget=20000",
    )
    size = f"--window-size={WIDTH},{TALLEST}"
    command = [browser, *flags, size, f"--screenshot={picture}", page.resolve().as_uri()]
    subprocess.run(command, check=True, stderr=subprocess.DEVNULL, timeout=120)


def trimmed(picture: Path) -> bytes:
    """Return a picture without the empty page below, in few colours."""
    from PIL import Image, ImageChops

    image = Image.open(picture).convert("RGB")
    empty = Image.new("RGB", image.size, image.getpixel((2, image.height - 2)))
    box = ImageChops.difference(image, empty).getbbox()
    assert box is not None
    small = io.BytesIO()
    cut = image.crop((0, 0, image.width, min(box[3] + 12, image.height)))
    cut.quantize(COLOURS, dither=Image.Dither.NONE).save(small, format="png", optimize=True)
    return small.getvalue()


def save(content: bytes, path: Path) -> None:
    """Write the bytes of a picture."""
    path.write_bytes(content)


def pictures_of(shown: Shown, data: Path, browser: str, folder: Path) -> None:
    """Calibrate one log and write its pictures into `folder`."""
    with tempfile.TemporaryDirectory() as name:
        scratch = Path(name)
        log = str(data.resolve() / f"{shown.log}.csv.gz")
        with contextlib.chdir(scratch):  # the report names the model as it was written
            code = run(["calibrate", log, *shown.options, "-o", "model.yaml", "--runs", "runs"])
        if code != shown.code:
            sys.exit(f"{shown.log}: exit code {code}, docs/results.md says {shown.code}")
        report = (scratch / "runs/latest/report.html").read_text(encoding="utf-8")
        for picture, title in shown.pictures.items():
            page, drawn = scratch / "page.html", scratch / picture
            page.write_text(alone(report, title), encoding="utf-8")
            photograph(browser, page, drawn)
            content = trimmed(drawn)
            if len(content) > LARGEST:
                sys.exit(f"{picture} has {len(content)} bytes, more than {LARGEST}")
            write_whole(folder / picture, partial(save, content))


def main(folder: Path) -> None:
    """Write all pictures into `folder`."""
    data = os.environ.get("SLIPWISE_DATA")
    if not data:
        sys.exit("SLIPWISE_DATA is not set: it names the folder that holds the real logs")
    browser = find_browser()
    for shown in REPORTS:
        pictures_of(shown, Path(data), browser, folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
