"""The run of the whole suite: what fails in the crowd runs again, alone."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from sweeps import sweep

TOOLS = Path(__file__).resolve().parents[2] / "tools"

FAILS_ONCE = """
from pathlib import Path

def test_{name}():
    mark = Path("{name}.ran")
    first = not mark.exists()
    mark.touch()
    assert not first
"""


@pytest.fixture
def suite(tmp_path, monkeypatch):
    """Runs a suite of its own with one worker; returns the exit status and what was printed."""
    monkeypatch.setenv("PYTEST_XDIST_AUTO_NUM_WORKERS", "1")
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")  # half of what it takes to begin
    monkeypatch.setenv("PYTEST_PLUGINS", "xdist.plugin")
    (tmp_path / "tools").mkdir()
    for name in ("suite.py", "build_studio.py"):
        shutil.copy(TOOLS / name, tmp_path / "tools")
    page = tmp_path / "jausml" / "authoring" / "studio" / "page" / "index.html"
    page.parent.mkdir(parents=True)
    page.touch()
    (tmp_path / "pyproject.toml").write_text("[tool.pytest.ini_options]\n", encoding="utf-8")

    def run(**tests):
        for name, text in tests.items():
            (tmp_path / f"test_{name}.py").write_text(text, encoding="utf-8")
        command = [sys.executable, "tools/suite.py"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        return done.returncode, done.stdout

    return run


@pytest.mark.slow
def test_what_passes_alone_is_named(suite):
    status, output = suite(once=FAILS_ONCE.format(name="once"))
    assert status == 0
    assert "test_once.py::test_once: passed alone, and may hide a race" in output


@pytest.mark.slow
def test_each_gets_its_own_verdict_and_shows_its_values_in_the_second_run(suite):
    bad = "def test_bad():\n    found = 6 * 7\n    assert found == 43\n"
    status, output = suite(bad=bad, once=FAILS_ONCE.format(name="once"))
    assert status == 1
    in_the_crowd, _, alone = output.partition("once more, alone")
    assert "assert 42 == 43" not in in_the_crowd
    assert "assert 42 == 43" in alone
    assert "test_bad.py::test_bad: fails alone too" in output
    assert "test_once.py::test_once: passed alone, and may hide a race" in output


@pytest.mark.slow
def test_many_failures_are_a_fault(suite):
    names = [f"once{number}" for number in range(4)]
    status, output = suite(**{name: FAILS_ONCE.format(name=name) for name in names})
    assert status == 1
    assert output.count("passed alone, and may hide a race") == 4


def test_nothing_chosen_is_no_failure(suite):
    assert suite()[0] == 0


@pytest.mark.slow
@pytest.mark.usefixtures("suite")
def test_an_interrupt_is_no_traceback(tmp_path):
    test = "def test_long():\n    import time\n    open('begun', 'x')\n    time.sleep(60)\n"
    (tmp_path / "test_long.py").write_text(test, encoding="utf-8")
    command = [sys.executable, "tools/suite.py"]
    process = subprocess.Popen(
        command,
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        end = time.monotonic() + 60
        while not (tmp_path / "begun").exists() and time.monotonic() < end:
            time.sleep(0.05)
        os.killpg(process.pid, signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    finally:
        process.kill()
        process.wait()
    assert (process.returncode, "Traceback" in errors) == (130, False), errors


# -- the page of the studio ------------------------------------------------------------------------

NPM = """#!/bin/sh
echo "npm $*" >> ../asked
case "$*" in
  *ci) [ -n "$NO_PACKAGES" ] && exit 1
    mkdir -p node_modules && touch node_modules/.package-lock.json;;
  *build) [ -n "$FAULTY" ] && echo "a type is wrong" && exit 1
    touch ../jausml/authoring/studio/page/index.html;;
esac
exit 0
"""
IS_BUILT = """
from pathlib import Path

def test_built():
    asked = Path("asked").read_text().splitlines()
    assert asked == ["npm --loglevel=error ci", "npm --loglevel=error run build"]
"""


@pytest.fixture
def stale(suite, tmp_path, monkeypatch):
    """A suite whose page is older than its sources, with a node."""
    programs = tmp_path / "programs"
    programs.mkdir()
    for name, text in {"npm": NPM, "node": "#!/bin/sh\necho v20.1.0\n"}.items():
        (programs / name).write_text(text, encoding="utf-8")
        (programs / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")
    (tmp_path / "studio").mkdir()
    (tmp_path / "studio" / "main.ts").touch()
    os.utime(tmp_path / "jausml" / "authoring" / "studio" / "page" / "index.html", (0, 0))
    return suite


def test_a_stale_page_is_built_once_before_the_tests(stale):
    for _ in range(2):
        status, output = stale(built=IS_BUILT)
        assert status == 0, output
    assert "page of the studio" not in output


def test_a_page_whose_build_fails_fails_the_suite(stale, monkeypatch):
    monkeypatch.setenv("FAULTY", "1")
    status, output = stale(good="def test_good(): pass")
    assert (status, "1 passed" in output) == (1, False)
    assert "page of the studio: built, its sources are newer\na type is wrong\n" in output


@pytest.mark.parametrize("lacking", sweep(["packages", "node"], every=2))
def test_a_page_that_cannot_be_built_is_told_and_no_fault(stale, monkeypatch, tmp_path, lacking):
    if lacking == "packages":
        monkeypatch.setenv("NO_PACKAGES", "1")
    else:
        (tmp_path / "programs" / "node").write_text("#!/bin/sh\necho v18.0.0\n")
    status, output = stale(good="def test_good(): pass")
    assert (status, "1 passed" in output, "once more" in output) == (0, True, False)
    assert output.count("page of the studio: not built") == 1
