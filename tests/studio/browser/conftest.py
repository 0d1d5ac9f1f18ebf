"""One browser for the tests of a module, and a studio for all of them or for each."""

import os
import re
import signal
import subprocess
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import urlsplit

import pytest
import warm
from browser import PATIENCE
from studio_client import Server

from jausml.language.model.library import LIBRARY_URI

MODELS = Path(__file__).parents[3] / "models"

_FAILED = pytest.StashKey[bool]()
_ADDRESS = re.compile(r"http://\S+#token=\S+")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item):
    """Notes which tests failed, for a picture of the page they failed at."""
    report = yield
    item.stash[_FAILED] = report.failed or item.stash.get(_FAILED, False)
    return report


class Studio:
    """A running `jausml studio`, or `jausml operate`."""

    def __init__(self, target: Path, log: Path, *options: str, line: Sequence[str] = ()) -> None:
        """Begins (`line`: how the command line begins, that of a studio without)."""
        self.log = log
        command = [*(line or (*warm.command(), "studio")), str(target), "--no-browser", *options]
        with log.open("w") as errors:
            self.process = subprocess.Popen(
                command,
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
                env={**os.environ, "PYTHONUNBUFFERED": "1"},
            )
        self.address = self._address()
        self.commanding_address = self._address() if "--stop-all" in options else ""

    def _address(self) -> str:
        said = ""
        for line in self.process.stdout:
            said += line
            if found := _ADDRESS.search(line):
                return found[0]
        raise AssertionError(f"no address: {said}{self.log.read_text()}")

    def close(self) -> None:
        """Ends it as Ctrl-C does."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        try:
            assert self.process.wait(timeout=20) == 0, self.log.read_text()
        finally:
            self.process.kill()
            self.process.wait()
            self.process.stdout.close()
        assert "Traceback" not in self.log.read_text(), self.log.read_text()


@pytest.fixture
def example(tmp_path):
    """The example vehicle in a folder of its own."""
    return _example_in(tmp_path)


def _example_in(folder):
    text = (MODELS / "catvehicle" / "catvehicle.xmi").read_text(encoding="utf-8")
    path = folder / "project" / "catvehicle.xmi"
    path.parent.mkdir()
    path.write_text(text.replace("../library/", LIBRARY_URI), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def running_studio(tmp_path_factory):
    """The example vehicle and a studio that has it open: it takes seconds to begin."""
    folder = tmp_path_factory.mktemp("shared")
    path = _example_in(folder)
    studio = Studio(path, folder / "studio.log")
    yield path, studio
    studio.close()


@pytest.fixture
def shared_example(running_studio):
    """The example vehicle in the studio of the module; what a test edits is undone after it."""
    path, studio = running_studio
    before, server = path.read_bytes(), Server(studio.process, studio.address)
    with server.page() as page:
        at = page.ask("log")["at"]
    yield path
    with server.page() as page:
        while page.ask("log")["at"] > at:
            page.ask("undo")
    assert path.read_bytes() == before


@pytest.fixture
def open_shared(running_studio, shared_example, open_studio):  # noqa: ARG001 - it is undone
    """Returns a function that opens a page of the studio of the module."""
    return lambda **options: open_studio.page_of(running_studio[1].address, **options)


@pytest.fixture
def open_studio(request, chromium, tmp_path_factory):
    """Returns a function that opens a model or folder in a page; both end with the test.

    No page may say anything in its console, be refused by its policy, or ask another host.
    """
    opened, contexts, complaints = [], [], []

    def open_(target, **options):
        studio = Studio(target, tmp_path_factory.mktemp("log") / "studio.log")
        opened.append(studio)
        return page_of(studio.address, **options)

    def page_of(address, prepare=None, **options):
        size = {"width": 1440, "height": 900}
        context = chromium.new_context(**{"viewport": size, "reduced_motion": "reduce", **options})
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(PATIENCE)
        host = urlsplit(address).netloc

        def note_request(request):
            if urlsplit(request.url).netloc not in (host, ""):  # data: has none
                complaints.append(f"request to {request.url}")

        page.on("request", note_request)
        page.on("pageerror", lambda error: complaints.append(f"page error: {error}"))
        page.on("console", lambda said: _note(said, complaints))
        if prepare is not None:
            prepare(page)
        page.goto(address)
        return page

    open_.page_of = page_of
    open_.studios, open_.complaints = opened, complaints
    yield open_
    for context in contexts:
        if request.node.stash.get(_FAILED, False):
            for page in context.pages:
                page.screenshot(path=tmp_path_factory.mktemp("last") / "page.png")
        context.close()
    for studio in opened:
        studio.close()
    assert complaints == []


def _note(said, complaints):
    if said.type in ("error", "warning"):
        complaints.append(f"console: {said.text}")
