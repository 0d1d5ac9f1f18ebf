"""The pages of the studio and of the operator unit, without a server and without a browser."""

import gzip
import subprocess

import pytest
from build_studio import PAGE, SOURCES, UNIT, environment, npm

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


@pytest.mark.parametrize("page", [PAGE, UNIT])
def test_nothing_stands_in_the_page_itself(page):
    """The policy forbids scripts and styles in the page; each file that it names is there."""
    text = page.read_text(encoding="utf-8")
    assert "<style" not in text
    assert "style=" not in text
    named = [
        part.partition('"')[0] for key in ("src", "href") for part in text.split(f'{key}="')[1:]
    ]
    own = [reference for reference in named if not reference.startswith("data:")]
    assert len(own) > 1
    assert all((page.parent / path).is_file() for path in own)
    assert text.count("<script") == text.count('<script type="module" crossorigin src="./')


@pytest.mark.parametrize(
    ("page", "names"),
    [(PAGE, ("preact", "@xyflow/react", "zustand")), (UNIT, ("preact", "zustand", "uplot"))],
)
def test_licences_of_what_is_in_it_are_beside_it(page, names):
    text = (page.parent / "licenses.md").read_text(encoding="utf-8")
    assert [name for name in names if name not in text] == []


@pytest.mark.parametrize(("page", "most"), [(PAGE, 300_000), (UNIT, 60_000)])
def test_all_of_it_stays_light(page, most):
    """What a slow link carries: all parts, though those that load late are seldom wanted."""
    parts = [path for path in (page.parent / "assets").iterdir() if path.suffix in (".js", ".css")]
    assert sum(len(gzip.compress(part.read_bytes())) for part in (page, *parts)) < most
