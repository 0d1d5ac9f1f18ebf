"""Why tests were skipped, a line for each reason, and whether so many may be for it.

With `--expected-skips FILE` a run fails in which tests are skipped for a reason that the file does
not have, or more of them than it allows. A line of it is `MOST | REASON | WHY`: so many tests, or
files that are skipped as a whole, may be for reasons that begin so. Others begin with `#`.
"""

from collections import Counter
from pathlib import Path
from typing import NamedTuple

import pytest


class Allowance(NamedTuple):
    """How many skips may be for a reason."""

    most: int
    reason: str
    why: str


_ALLOWANCES = pytest.StashKey[list[Allowance]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds the option."""
    text = "fail where tests are skipped that this file does not allow (tests/expected_skips.txt)"
    parser.addoption("--expected-skips", metavar="FILE", help=text)


def pytest_configure(config: pytest.Config) -> None:
    """Reads the file, before any test is run in vain."""
    path = config.getoption("--expected-skips")
    if path is not None:
        try:
            config.stash[_ALLOWANCES] = read(Path(path).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise pytest.UsageError(f"--expected-skips {path}: {error}") from error


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Fails a run that would pass."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if reporter is None or session.exitstatus != pytest.ExitCode.OK:
        return
    if surplus(_reasons(reporter), session.config):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Gives a line for each reason, and for each that is not expected."""
    reasons = _reasons(terminalreporter)
    for reason, count in sorted(reasons.items()):
        terminalreporter.write_line(f"{count} skipped: {reason}")
    for line in surplus(reasons, terminalreporter.config):
        terminalreporter.write_line(f"not expected: {line}", red=True)


def _reasons(reporter: pytest.TerminalReporter) -> Counter[str]:
    skipped = reporter.getreports("skipped")
    return Counter(report.longrepr[2].removeprefix("Skipped: ") for report in skipped)


def surplus(reasons: Counter[str], config: pytest.Config) -> list[str]:
    """Returns what is skipped beyond what the file of the option allows, nothing without one."""
    allowances = config.stash.get(_ALLOWANCES, None)
    return [] if allowances is None else beyond(reasons, allowances)


def beyond(reasons: Counter[str], allowances: list[Allowance]) -> list[str]:
    """Returns what is skipped beyond what is allowed; of two allowances the longer one counts."""
    longest = sorted(allowances, key=lambda candidate: -len(candidate.reason))
    counted: Counter[Allowance] = Counter()
    found = []
    for reason, count in sorted(reasons.items()):
        allowance = next(
            (candidate for candidate in longest if reason.startswith(candidate.reason)), None
        )
        if allowance is None:
            found.append(f"{count} skipped: {reason}")
        else:
            counted[allowance] += count
    for allowance, count in counted.items():
        if count > allowance.most:
            found.append(f"{count} skipped, at most {allowance.most} may be: {allowance.reason}")
    return found


def read(text: str) -> list[Allowance]:
    """Reads a file of allowances.

    Raises:
        ValueError: A line is none.
    """
    found = []
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.startswith("#"):
            continue
        most, *rest = (part.strip() for part in line.split("|"))
        if not (most.isascii() and most.isdigit() and len(rest) == 2 and all(rest)):
            raise ValueError(f"line {number} is not MOST | REASON | WHY: {line!a}")
        found.append(Allowance(int(most), *rest))
    return found
