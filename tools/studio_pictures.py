"""Writes docs/studio-*.png: the page of `jausml studio` with the example, as a browser shows it."""

from __future__ import annotations

import io
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image
from playwright.sync_api import sync_playwright

from jausml.model.uris import LIBRARY_URI

if TYPE_CHECKING:
    from playwright.sync_api import Page, ViewportSize

ROOT = Path(__file__).resolve().parent.parent
MODEL = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
SIZE: ViewportSize = {"width": 1280, "height": 800}
COLOURS = 128
"""Few colours make small files."""

VIEWS = {"system": "system", "map": "map:velocity_state"}
"""What is shown, by the ends of the files' names."""


def main() -> None:
    """Opens the example, and takes a picture of each view."""
    with tempfile.TemporaryDirectory() as folder:
        model = Path(folder) / "robot" / "catvehicle.xmi"
        model.parent.mkdir()
        text = MODEL.read_text(encoding="utf-8").replace("../library/", LIBRARY_URI)
        model.write_text(text, encoding="utf-8")
        line = [sys.executable, "-u", "-m", "jausml", "studio", str(model), "--no-browser"]
        with subprocess.Popen(line, stdout=subprocess.PIPE, text=True) as studio:
            try:
                _take_all(_address(studio))
            finally:
                studio.terminate()


def _address(studio: subprocess.Popen[str]) -> str:
    for line in studio.stdout or ():
        if found := re.search(r"http://\S+", line):
            return found[0]
    raise SystemExit("studio_pictures: the studio does not start")


def _take_all(address: str) -> None:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"))
        page = browser.new_page(viewport=SIZE, reduced_motion="reduce", color_scheme="light")
        page.goto(address)
        for name, view in VIEWS.items():
            page.locator(".box").first.wait_for()
            page.locator(".header select").nth(1).select_option(view)
            page.locator(f".react-flow__node[data-id] .box.{_kind(view)}").first.click()
            page.get_by_role("form").wait_for()
            page.get_by_text("No problems.").first.wait_for()
            _write(page, ROOT / "docs" / f"studio-{name}.png")
        browser.close()


def _kind(view: str) -> str:
    return "bridge" if view == "system" else "message"


def _write(page: Page, path: Path) -> None:
    picture = Image.open(io.BytesIO(page.screenshot()))
    picture.convert("RGB").quantize(COLOURS).save(path, optimize=True)
    print(path.relative_to(ROOT), path.stat().st_size)


if __name__ == "__main__":
    main()
