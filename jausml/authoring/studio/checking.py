"""Problems: what the rules say about a file, worked out once for each revision of the project."""

from __future__ import annotations

import gc
import logging
import threading
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.project import Project
from jausml.authoring.editing.records import Freshness
from jausml.authoring.studio.views.palette import library_entries
from jausml.language.model.reading.reader import ReadResult
from jausml.language.validation.engine import RuleError, SupersededError, check
from jausml.language.validation.rule import Report

_LOG = logging.getLogger(__name__)

_PAUSE = 5.0  # seconds without a wish after which garbage of verdicts is collected

_STEPS = 20_000, 20, 1_000_000
"""Thresholds of the collector while a session runs: steps of some milliseconds, and never all."""

_MOST_UNTIDY = 8  # verdicts after which garbage is collected all the same: models are large


@dataclass(frozen=True)
class Verdict:
    """The findings about a file and all files that it refers to.

    `freshness`: what that is worth: rules were run if it is current. `fault`: why no rules were
    run, empty when they were.
    """

    file: str
    revision: int
    elapsed_ms: float
    result: ReadResult
    freshness: Freshness
    report: Report
    fault: str = ""


class Verdicts:
    """The latest verdict on each file."""

    def __init__(self, project: Project) -> None:
        self._project = project
        self._verdicts: dict[str, Verdict] = {}
        self._judging: dict[str, threading.Lock] = {}
        self._lock = threading.Lock()

    @property
    def revision(self) -> int:
        """The revision of the project now."""
        return self._project.revision

    def of(self, file: str) -> Verdict:
        """Returns the present verdict on a file; simultaneous callers get the same one."""
        with self._lock:
            judging = self._judging.setdefault(file, threading.Lock())
        with judging:
            verdict = self._verdicts.get(file)
            while verdict is None or verdict.revision != self._project.revision:
                with suppress(SupersededError):
                    verdict = self._verdicts[file] = self._judged(file)
            return verdict

    def _judged(self, file: str) -> Verdict:
        started = time.perf_counter()
        revision = self._project.revision
        result, freshness = self._project.read(file)
        report, fault = _checked(result, freshness, lambda: self._project.revision == revision)
        elapsed = 1000 * (time.perf_counter() - started)
        return Verdict(file, revision, elapsed, result, freshness, report, fault)


def _checked(
    result: ReadResult, freshness: Freshness, is_wanted: Callable[[], bool]
) -> tuple[Report, str]:
    if not freshness.is_current:
        # What was read is of the past: about that there is no verdict.
        return Report(result.model, (), freshness.faults), freshness.why
    try:
        return check(result, is_wanted=is_wanted), ""
    except RuleError as error:
        # What was read is told all the same: an editor holds models that are half written.
        return Report(result.model, (), tuple(result.diagnostics)), str(error)


class Checking(threading.Thread):
    """Judges files beside everything else, and tells each verdict that still holds."""

    def __init__(
        self,
        verdicts: Verdicts,
        files: Callable[[], Iterable[str]],
        notify: Callable[[Verdict], None],
    ) -> None:
        super().__init__(name="checking", daemon=True)
        self._verdicts = verdicts
        self._files = files
        self._notify = notify
        self._wanted = threading.Event()
        self._is_closed = False

    def begin(self) -> None:
        """Judges all files that a page looks at, but for those with a present verdict."""
        self._wanted.set()

    def close(self) -> None:
        """Ends the thread, after the file that is being judged."""
        self._is_closed = True
        self._wanted.set()

    def run(self) -> None:
        """Waits for wishes until it is closed.

        Collects garbage of models too, in the pauses after changes: no one else is to wait for
        that, and at rest there is none.
        """
        thresholds = gc.get_threshold()
        gc.set_threshold(*_STEPS)
        try:
            self._wait()
        finally:
            gc.unfreeze()
            gc.set_threshold(*thresholds)

    def _wait(self) -> None:
        untidy = 0
        while not self._is_closed:
            if self._wanted.wait(_PAUSE if untidy else None):
                self._wanted.clear()
                self._judge_all()
                untidy += 1
                if untidy < _MOST_UNTIDY:
                    continue
            gc.collect()
            untidy = 0

    def _judge_all(self) -> None:
        for file in self._files():
            # Where something has changed meanwhile all begins anew.
            if self._is_closed or self._wanted.is_set():
                return
            self._judge(file)

    def _judge(self, file: str) -> None:
        try:
            verdict = self._verdicts.of(file)
            if verdict.revision == self._verdicts.revision:
                self._notify(verdict)
        except EditError:
            return  # it has gone meanwhile
        except Exception:
            # The next change is judged all the same.
            _LOG.exception("%s was not judged", file)


def prepare() -> None:
    """Reads the library, and has the collector look no more at what stays forever, such as that.

    It takes seconds on a busy computer: better before somebody asks for it.
    """
    library_entries()
    gc.collect()
    gc.freeze()
