"""Writes docs/studio-*.png: the page of `jausml studio` as a browser shows it.

The example's system and one of its maps, and the smallest system while it runs.
"""

from __future__ import annotations

import argparse
import io
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Page, ViewportSize, sync_playwright

from jausml.language.model.library import LIBRARY_URI

ROOT = Path(__file__).resolve().parent.parent
MODELS = ROOT / "models"
SENSOR = """
from .messages import ReportVelocityState
from .sensor_base import SensorBase


class Sensor(SensorBase):
    def report_velocity_state(self, query, sender):
        return ReportVelocityState(velocity_x=1.0, yaw_rate=0.2)
"""
"""What drives in a circle to the right."""

SIZE: ViewportSize = {"width": 1280, "height": 800}
COLOURS = 128
"""Few colours make small files."""

VIEWS = {"system": "system", "map": "map:velocity_state"}
"""What is shown of the example, by the ends of the files' names."""

PATIENCE = 90_000
"""Milliseconds until what runs is seen."""

HIGHER = 10
"""Steps by which the lower panel grows, so that both messages are seen."""

JAUSML = (sys.executable, "-u", "-m", "jausml")
ENVIRONMENT = {"ROS_DOMAIN_ID": "86", **os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}


def main() -> None:
    """Takes all pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / "docs")
    parser.add_argument("--dark", action="store_true", help="as who likes it dark sees it")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"))
        pictures = Pictures(browser, options.folder, "dark" if options.dark else "light")
        pictures.take_views(_copied("catvehicle/catvehicle.xmi", Path(folder)))
        pictures.take_live(_copied("minimal/minimal.xmi", Path(folder)))
        browser.close()


def _copied(model: str, folder: Path) -> Path:
    """Returns a copy of a shipped model in a folder of its own."""
    path = folder / model
    path.parent.mkdir()
    text = (MODELS / model).read_text(encoding="utf-8").replace("../library/", LIBRARY_URI)
    path.write_text(text, encoding="utf-8")
    return path


class Pictures:
    """Takes pictures of pages.

    Args:
        browser: The browser.
        folder: Where they are written.
        scheme: Whether the page is `light` or `dark`.
    """

    def __init__(self, browser: Browser, folder: Path, scheme: str) -> None:
        self._browser = browser
        self._folder = folder
        self._scheme = scheme

    def take_views(self, model: Path) -> None:
        """Takes the views of the example."""
        with self._opened(model) as page:
            for name, view in VIEWS.items():
                page.locator(".header select").nth(1).select_option(view)
                kind = "bridge" if view == "system" else "message"
                page.locator(f".react-flow__node[data-id] .box.{kind}").first.click()
                page.get_by_role("form").wait_for()
                page.get_by_text("No problems.").first.wait_for()
                self._write(page, name)

    def take_live(self, model: Path) -> None:
        """Takes the smallest system while it runs, with a message that crosses."""
        workspace = model.parent / "ws"
        subprocess.run([*JAUSML, "generate", str(model), "-o", str(workspace)], check=True)
        (workspace / "sensor" / "sensor" / "sensor.py").write_text(SENSOR, encoding="utf-8")
        with _started("run", str(workspace)), self._opened(model) as page:
            page.get_by_role("tab", name="Live").click()
            page.get_by_role("button", name="Watch", exact=True).click()
            page.locator(".line.live-ok").first.wait_for(timeout=PATIENCE)
            page.get_by_role("region", name="Live").get_by_role("button", name="/").first.click()
            page.get_by_text("Velocity_X: 1").wait_for(timeout=PATIENCE)
            page.get_by_text("z: -0.2").wait_for(timeout=PATIENCE)
            page.get_by_role("separator", name="Height of the lower panel").focus()
            for _ in range(HIGHER):
                page.keyboard.press("ArrowUp")
            page.get_by_role("button", name="Fit").click()
            self._write(page, "live")

    @contextmanager
    def _opened(self, model: Path) -> Iterator[Page]:
        with _started("studio", str(model), "--no-browser") as studio:
            page = self._browser.new_page(
                viewport=SIZE,
                reduced_motion="reduce",
                color_scheme="dark" if self._scheme == "dark" else "light",
            )
            page.goto(_address(studio))
            page.locator(".box").first.wait_for()
            yield page
            page.close()

    def _write(self, page: Page, name: str) -> None:
        path = self._folder / f"studio-{name}.png"
        picture = Image.open(io.BytesIO(page.screenshot()))
        picture.convert("RGB").quantize(COLOURS).save(path, optimize=True)
        print(path, path.stat().st_size)


@contextmanager
def _started(*words: str) -> Iterator[subprocess.Popen[str]]:
    """Runs a verb as long as it is needed."""
    line = [*JAUSML, *words]
    with subprocess.Popen(line, stdout=subprocess.PIPE, text=True, env=ENVIRONMENT) as process:
        try:
            yield process
        finally:
            process.send_signal(signal.SIGINT)
            process.communicate()


def _address(studio: subprocess.Popen[str]) -> str:
    for line in studio.stdout or ():
        if match := re.search(r"http://\S+", line):
            return match[0]
    raise SystemExit("studio_pictures: the studio does not start")


if __name__ == "__main__":
    main()
