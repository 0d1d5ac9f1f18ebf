"""From an edit in the studio to the verdict on it: over a socket, as a page does it.

By the clock, for that is what somebody waits for: from sending the edit until the problems of what
it led to are here. In between the change is planned, checked by reading its result, and written;
and all rules run. The page then asks what has changed in its picture; processor time tells of both.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import growth
from figures import rounded
from scale import Scale
from websockets.sync.client import ClientConnection, connect

from jausml.language.model import read_models
from jausml.language.model.uris import LIBRARY_URI
from jausml.language.text.notation import NOTATIONS

ROOT = Path(__file__).resolve().parent.parent
EXAMPLE = "the example"
ELEMENTS = 1_000
"""Of the other model: a bridge of connections, each of a map of its own."""

_ELEMENTS_EACH = 8
_EDITS = 15
_LONGEST = 120.0
_PROGRAM = """
import sys
from pathlib import Path
from jausml.cli import main
from jausml.authoring.studio import serving
serving.PAGE = Path(sys.argv.pop(1))
main()
"""
"""The studio with an empty page: the built one may not be there."""


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures all.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        For each model its `elements` without those of the library, the `median` and the `worst`
        time from edit to verdict, and the median `processor` times of the server for that and for
        the `picture`, in milliseconds.
    """
    figures_by_model = {EXAMPLE: _measured(_example(), scale, folder / "example" / "edited.xmi")}
    xmi = growth.connections(ELEMENTS // _ELEMENTS_EACH, own_maps=True, own_frames=True)
    figures_by_model[f"{ELEMENTS:,} elements"] = _measured(
        xmi, scale, folder / "grown" / "edited.xmi"
    )
    for name, figures in figures_by_model.items():
        print(f"  {name}: {figures}", flush=True)
    return figures_by_model


def _example() -> str:
    text = (ROOT / "models" / "catvehicle" / "catvehicle.xmi").read_text(encoding="utf-8")
    return text.replace("../library/", LIBRARY_URI)


def _measured(text: str, scale: Scale, path: Path) -> dict[str, float]:
    path.parent.mkdir()
    path.write_text(text, encoding="utf-8")
    model = read_models([path], notations=NOTATIONS).model
    elements = sum(1 for _ in model.elements(library=False))
    with _page(path) as page:
        page.look()
        page.edit(0)  # loads what edits need
        page.picture()
        times, processor, pictures = [], [], []
        for number in range(1, scale.count(_EDITS, 2) + 1):
            busy, started = page.processor_ms(), time.perf_counter()
            page.edit(number)
            times.append(1e3 * (time.perf_counter() - started))
            judged = page.processor_ms()
            processor.append(judged - busy)
            page.picture()
            pictures.append(page.processor_ms() - judged)
    return {
        "elements": elements,
        "median": rounded(statistics.median(times)),
        "worst": rounded(max(times)),
        "processor": rounded(statistics.median(processor)),
        "picture": rounded(statistics.median(pictures)),
    }


@contextmanager
def _page(path: Path) -> Iterator[_Page]:
    page = path.parent / "page"
    page.mkdir()
    (page / "index.html").write_text("", encoding="utf-8")
    line = [sys.executable, "-c", _PROGRAM, str(page), "studio", "--no-browser", str(path)]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        assert process.stdout is not None
        address = urlsplit(process.stdout.readline().split()[-1])
        origin = f"http://{address.netloc}"
        with connect(f"ws://{address.netloc}/socket", origin=origin, max_size=None) as socket:
            page_ = _Page(socket, process.pid, path.name)
            page_.ask("hello", token=address.fragment.removeprefix("token="))
            yield page_
    finally:
        process.terminate()
        process.wait(_LONGEST)


class _Page:
    """Just enough of a page to edit and to be told."""

    def __init__(self, socket: ClientConnection, process: int, file: str) -> None:
        self._socket = socket
        self._process = process
        self._file = file
        self._picture = 0
        self._asked = 0
        self._judged = -1
        self._element = ""

    def look(self) -> None:
        """Looks at the system, as pages do, and chooses its first bridge."""
        self.ask("problems", file=self._file)
        self.picture()
        form = self.ask("form", element=f"{self._file}#/")
        owned = next(child for child in form["children"] if child["feature"] == "bridges")
        self._element = owned["elements"][0]["element"]

    def ask(self, method: str, **params: Any) -> Any:
        """Returns the answer to a request."""
        self._asked += 1
        message = {"jsonrpc": "2.0", "id": self._asked, "method": method, "params": params}
        self._socket.send(json.dumps(message))
        while (answer := self._next()).get("id") != self._asked:
            pass
        return answer["result"]

    def picture(self) -> None:
        """Asks what has changed in the picture of the system."""
        wanted = {"file": self._file, "view": "system", "opened": [], "base": self._picture}
        self._picture = self.ask("view", **wanted)["picture"]

    def edit(self, number: int) -> None:
        """Gives the bridge another documentation, and waits for the verdict."""
        text = [f"edit {number}"]
        change = {
            "kind": "set",
            "element": self._element,
            "feature": "documentation",
            "values": text,
        }
        revision = self.ask("edit", commands=[change], label="measure")["revision"]
        while self._judged < revision:
            self._next()

    def processor_ms(self) -> float:
        """Returns the processor time of the server until now, in milliseconds."""
        stat = Path(f"/proc/{self._process}/stat").read_text(encoding="ascii")
        fields = stat.rpartition(")")[2].split()
        return 1e3 * (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def _next(self) -> dict[str, Any]:
        message: dict[str, Any] = json.loads(self._socket.recv(_LONGEST))
        if message.get("method") == "problems":
            self._judged = message["params"]["revision"]
        return message
