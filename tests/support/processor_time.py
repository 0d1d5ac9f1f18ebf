"""A plugin: the processor time of each file of tests, and whether a table has the dear ones.

What `make test` costs is held by a table in CONTRIBUTING.md: each file of tests that takes more
than ten seconds stands there with a reason. `--judge-budget` fails a run that finds the table wrong
by more than half: one of figure and seconds is less than half of the other. Less than that the
noise of another computer may be. Seconds are those of the computer on which the table was made: a
piece of work of fixed size tells how much faster or slower this one is. They are those of a run
from nothing: where an earlier one has left what it had compiled, a file may take less.

Of a run that has the slow tests too, the others alone may not take more than the table says; they
may take less where a slow one of the file came first to what both need.
"""

import re
import resource
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import warm

ROOT = Path(__file__).resolve().parents[2]
TABLE = ROOT / "CONTRIBUTING.md"
TOLERANCE = 2.0
"""So many times a figure may be off, either way."""
UNLISTED = 25.0
"""Seconds that a file may take that is not in the table: a process counts where it ends, which may
be in another file than the one that began it."""
SHOWN = 10

_ROW = re.compile(r"^\| `([\w/]+\.py)` \| (\d+) \| .+ \|$", re.MULTILINE)
_WORK = 300_000
WORK_SECONDS = 0.0105
"""Seconds that the piece of work takes on the computer of the table."""

_SPENT = pytest.StashKey[Counter[str]]()
_GUARDING = pytest.StashKey[Counter[str]]()
"""What is spent by tests that are not slow."""
_ELSEWHERE: Counter[str] = Counter()
"""What tests have spent that is counted to another file."""
_FROM_NOTHING = pytest.StashKey[bool]()
_WORK_BEFORE = pytest.StashKey[float]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds the option."""
    parser.addoption(
        "--judge-budget",
        action="store_true",
        help="fail where the table of dear files in CONTRIBUTING.md is wrong by more than half",
    )


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config: pytest.Config) -> None:
    """Begins at nothing, and looks whether an earlier run has left something."""
    config.stash[_SPENT], config.stash[_GUARDING] = Counter(), Counter()
    config.stash[_FROM_NOTHING] = not (config.rootpath / ".pytest_cache" / "d").exists()
    config.stash[_WORK_BEFORE] = work_seconds() if config.getoption("judge_budget") else 0.0


@contextmanager
def counted_to(file: str) -> Iterator[None]:
    """Counts what is spent meanwhile to a file, and not to the test that happens to come first."""
    before = _seconds()
    try:
        yield
    finally:
        _ELSEWHERE[file] += _seconds() - before


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[Any]:
    """Notes what a test and its fixtures take, with the processes that ended meanwhile."""
    before, elsewhere = _seconds(), _ELSEWHERE.total()
    try:
        return (yield)
    finally:
        file = item.nodeid.partition("::")[0].removeprefix("tests/")
        spent = _seconds() - before - (_ELSEWHERE.total() - elsewhere)
        item.config.stash[_SPENT][file] += spent
        if item.get_closest_marker("slow") is None:
            item.config.stash[_GUARDING][file] += spent


@pytest.hookimpl(tryfirst=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Hands what a worker has noted to the process that tells it."""
    stash = session.config.stash
    stash[_SPENT].update(_ELSEWHERE)
    if hasattr(session.config, "workeroutput"):
        noted = [dict(stash[_SPENT]), dict(stash[_GUARDING])]
        session.config.workeroutput["processor_time"] = noted


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """Adds what a worker has noted; nothing is known of one that has crashed."""
    noted = getattr(node, "workeroutput", {}).get("processor_time", ({}, {}))
    for key, spent in zip((_SPENT, _GUARDING), noted, strict=True):
        node.config.stash[key].update(spent)


@pytest.hookimpl(trylast=True)
def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Tells the dearest files, and where the table is wrong if it is to be judged."""
    config = terminalreporter.config
    spent = config.stash[_SPENT]
    files = ", ".join(f"{file} {seconds:.0f}" for file, seconds in spent.most_common(SHOWN))
    total, guarding = spent.total(), config.stash[_GUARDING].total()
    terminalreporter.write_line(
        f"processor time of tests: {total:.0f} s, {guarding:.0f} of it not slow; most of it {files}"
    )
    for line in _found(config):
        terminalreporter.write_line(f"{TABLE.name}: {line}", red=True)


@pytest.hookimpl(trylast=True, wrapper=True)
def pytest_cmdline_main(config: pytest.Config) -> Iterator[Any]:
    """Lets a run fail by its table alone."""
    status = yield
    return status or int(bool(_found(config)))


def _found(config: pytest.Config) -> list[str]:
    if hasattr(config, "workerinput") or not config.getoption("judge_budget"):
        return []
    # Others may slow this computer down for a moment, but nothing makes it faster.
    work = min(config.stash[_WORK_BEFORE], work_seconds())
    listed = table(TABLE.read_text(encoding="utf-8"))
    guarding, spent = (scaled(config.stash[key], work) for key in (_GUARDING, _SPENT))
    return differences(listed, guarding, spent if config.stash[_FROM_NOTHING] else None)


def table(text: str) -> dict[str, int]:
    """Returns the seconds of the files that a page lists."""
    return {file: int(seconds) for file, seconds in _ROW.findall(text)}


def scaled(spent: Mapping[str, float], own_seconds: float) -> dict[str, float]:
    """Returns times as they would be on the computer of the table.

    Args:
        spent: Seconds of each file on this one.
        own_seconds: Seconds that the piece of work takes on this one.
    """
    return {file: seconds * WORK_SECONDS / own_seconds for file, seconds in spent.items()}


def differences(
    listed: Mapping[str, int], guarding: Mapping[str, float], spent: Mapping[str, float] | None
) -> list[str]:
    """Returns a line for each file that a table leaves out, or whose figure is far off.

    Args:
        listed: The seconds of the table.
        guarding: Seconds of tests that are not slow.
        spent: Seconds of all tests; None where something was there that an earlier run had
            compiled, so that a file may take less.
    """
    lines = []
    for file in sorted({*listed, *guarding}):
        seconds, figure = guarding.get(file, 0.0), listed.get(file)
        if figure is None:
            if seconds > UNLISTED:
                lines.append(f"{file} takes {seconds:.0f} s and is not listed")
        elif seconds > figure * TOLERANCE or (
            spent is not None and spent.get(file, 0.0) < figure / TOLERANCE
        ):
            lines.append(f"{file} takes {seconds:.0f} s, and {figure} s are listed")
    return lines


def work_seconds() -> float:
    """Returns the processor time that a piece of work of fixed size takes, the least of five."""

    def work() -> float:
        began = time.process_time()
        sum(number % 7 for number in range(_WORK))
        return time.process_time() - began

    return min(work() for _ in range(5))


def _seconds() -> float:
    """Returns the processor time of this process, and of its children that have ended."""
    own = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in own) + warm.seconds()
