"""The page of the studio, tested without a server and without a browser."""

from __future__ import annotations

import gzip
import re
import subprocess

import pytest
from build_studio import PAGE, SOURCES, environment, npm

GUARDS = ("studio",)

pytestmark = [pytest.mark.needs("page"), pytest.mark.timeout(300)]


@pytest.mark.slow
@pytest.mark.needs("npm")
@pytest.mark.parametrize("script", ["lint", "types", "test"])
def test_its_own_checks_pass(script):
    result = subprocess.run(
        [npm(), "run", script],
        cwd=SOURCES,
        env={**environment(), "NO_COLOR": "1", "CI": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert result.returncode == 0, result.stdout[-4000:]


def test_nothing_stands_in_the_page_itself():
    """The policy forbids scripts and styles in the page; each file that it names is there."""
    text = PAGE.read_text(encoding="utf-8")
    assert "<style" not in text
    assert "style=" not in text
    named = [
        part.partition('"')[0] for key in ("src", "href") for part in text.split(f'{key}="')[1:]
    ]
    own = [reference for reference in named if not reference.startswith("data:")]
    assert len(own) > 1
    assert all((PAGE.parent / path).is_file() for path in own)
    assert text.count("<script") == text.count('<script type="module" crossorigin src="./')


def test_licences_of_what_is_in_it_are_beside_it():
    text = (PAGE.parent / "licenses.md").read_text(encoding="utf-8")
    for name in ("react", "@xyflow/react", "zustand", "uplot"):
        assert name in text


def test_all_of_it_stays_light():
    """What a slow link carries: all parts, though those that load late are seldom wanted."""
    parts = [path for path in (PAGE.parent / "assets").iterdir() if path.suffix in (".js", ".css")]
    assert sum(len(gzip.compress(part.read_bytes())) for part in parts) < 700_000
    # Who edits models does not load the operator unit, nor what draws its plots.
    first = re.findall(r'src="\./([^"]+)"', PAGE.read_text(encoding="utf-8"))
    assert all("Take control" not in (PAGE.parent / script).read_text() for script in first)
