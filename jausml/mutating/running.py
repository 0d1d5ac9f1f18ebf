"""Runs of campaigns: each mutation is made, judged, generated and tested, in several processes."""

from __future__ import annotations

import multiprocessing
import os
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jausml.generation import GenerationError, load_targets, render, select
from jausml.language.model import Severity, read_models
from jausml.language.model.reading.library_cache import LibraryCache
from jausml.language.model.xmi.writer import UnwritableError, to_xmi
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check
from jausml.mutating.broken_workspace import BrokenWorkspace
from jausml.mutating.outcomes import (
    CHECK,
    EQUAL,
    GENERATE,
    NOTHING,
    PROVE,
    RUN,
    TESTS,
    VALIDATE,
    WARNING,
    Outcome,
)
from jausml.mutating.products import Products
from jausml.mutating.proofs import Proofs

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.generation import Target
    from jausml.language.model import Diagnostic, Model
    from jausml.language.project.reading import Reading
    from jausml.language.validation.report import Report
    from jausml.mutating.mutations import Mutation


class CampaignError(Exception):
    """A campaign cannot run, or a process of it has ended."""


@dataclass(frozen=True)
class Settings:
    """How a campaign runs.

    Attributes:
        budget: Seconds after which no further mutation is begun.
        jobs: How many processes work at once.
        command: What else tries the packages of a model, as arguments of a process.
    """

    reading: Reading
    budget: float
    jobs: int
    command: Sequence[str] = ()


def outcomes(
    model: Model, chosen: Sequence[Mutation], settings: Settings
) -> Iterator[tuple[int, Outcome] | str]:
    """Yields what becomes of mutations, by their number and in any order, and remarks as texts.

    Raises:
        CampaignError: The model cannot be written, nothing can be generated of it, or a process
            has ended.
    """
    if not hasattr(os, "fork"):
        raise CampaignError("mutations need a system that can fork, such as Linux")
    original = _Original(model, settings.reading)
    context = multiprocessing.get_context("fork")
    queue, taken = context.SimpleQueue(), context.Value("i", 0)
    deadline = time.monotonic() + settings.budget
    # Here, and not in the processes: these may be ended at any time.
    with tempfile.TemporaryDirectory(prefix="jausml_mutants_") as folder:
        workers = [
            context.Process(
                target=_work,
                args=(
                    original,
                    chosen,
                    Path(folder) / str(number),
                    settings.command,
                    taken,
                    queue,
                    deadline,
                ),
            )
            for number in range(max(1, min(settings.jobs, len(chosen))))
        ]
        for each in workers:
            each.start()
        try:
            yield from _received(queue, workers)
        finally:
            for each in workers:
                each.terminate()
                each.join()


def _received(queue: Any, workers: Sequence[Any]) -> Iterator[tuple[int, Outcome] | str]:
    at_work = len(workers)
    while at_work:
        while queue.empty():
            if any(each.exitcode for each in workers):
                raise CampaignError("a process of the campaign has ended")
            time.sleep(0.02)
        found = queue.get()
        if isinstance(found, Exception):
            raise CampaignError(str(found))
        if found is None:
            at_work -= 1
        else:
            yield found


def _work(
    original: _Original,
    chosen: Sequence[Mutation],
    folder: Path,
    command: Sequence[str],
    taken: Any,
    queue: Any,
    deadline: float,
) -> None:
    """Tries mutations until there are no more, in a process of its own."""
    try:
        files = {**original.shared, **original.files}
        workspace = BrokenWorkspace(folder, files, command)
        for remark in _prepared(workspace) if time.monotonic() < deadline else ():
            queue.put(remark)
        while time.monotonic() < deadline:
            with taken.get_lock():
                number, taken.value = taken.value, taken.value + 1
            if number >= len(chosen):
                break
            queue.put((number, original.outcome(chosen[number], workspace)))
    except Exception as error:
        queue.put(CampaignError(f"{type(error).__name__}: {error}"))
    queue.put(None)


def _prepared(workspace: BrokenWorkspace) -> Iterator[str]:
    """Runs command and tests on what is not broken, and yields what of them says nothing."""
    if problem := workspace.sound_command():
        yield f"the command fails without a mutation: {problem}"
    try:
        workspace.preload()
    except ImportError as error:
        workspace.packages = []
        yield f"the generated tests do not run: {error}"
        return
    for package, problem in workspace.sound().items():
        yield f"the tests of {package} fail without a mutation: {problem}"


class _Original:
    """A model as one XMI document, what it generates, and what is found in it."""

    def __init__(self, model: Model, reading: Reading) -> None:
        self._model = model
        self._roots = [each for one in model.documents if not one.is_library for each in one.roots]
        self._path = model.documents[0].path.with_suffix(".xmi")
        self._root = reading.project_root or self._path.parent
        self._reading = reading
        self._cache = LibraryCache()
        targets = select(load_targets()).targets
        self._targets = [each for each in targets if not each.is_shared]
        report = self._report(self._text())
        self._proofs = Proofs(report)
        self._products = Products(report.model)
        self._known = {_key(each) for each in report.diagnostics}
        if report.has_errors:
            raise CampaignError(f"the model as one XMI document: {report.diagnostics[0].message}")
        try:
            self.files = self._rendered(report.model, self._targets)
            self.shared = self._rendered(report.model, [t for t in targets if t.is_shared])
        except GenerationError as error:
            raise CampaignError(f"nothing can be generated: {error}") from error

    def outcome(self, mutation: Mutation, workspace: BrokenWorkspace) -> Outcome:
        """Returns what becomes of a mutation."""
        undoing = mutation.change.made()
        try:
            text = self._text()
        except UnwritableError as error:
            return _outcome(mutation, VALIDATE, str(error))
        finally:
            undoing.made()
        report = self._report(text)
        new = [each for each in report.diagnostics if _key(each) not in self._known]
        errors = [each for each in new if each.severity is Severity.ERROR]
        if errors:
            return _outcome(mutation, VALIDATE, _told(errors[0]))
        try:
            files = self._rendered(report.model, self._targets)
        except GenerationError as error:
            return _outcome(mutation, GENERATE, str(error))
        changed = workspace.differing({**self.shared, **files})
        failed = workspace.failing(files, changed) if changed else ""
        if failed:
            return _outcome(mutation, TESTS, failed, changed)
        proved = self._proofs.noticed(report, mutation.change.element) if changed else ""
        if proved:
            return _outcome(mutation, PROVE, proved, changed)
        violated = self._products.noticed(report.model) if changed else ""
        if violated:
            return _outcome(mutation, CHECK, violated, changed)
        refused = workspace.refusing(files, changed) if changed else ""
        if refused:
            return _outcome(mutation, RUN, refused, changed)
        warnings = [each for each in new if each.severity is Severity.WARNING]
        if warnings:
            return _outcome(mutation, WARNING, _told(warnings[0]), changed)
        if not changed:
            return _outcome(mutation, EQUAL, "", changed)
        return _outcome(mutation, NOTHING, workspace.why_unseen(changed), changed)

    def _text(self) -> str:
        return to_xmi(self._roots, self._model, self._path)

    def _report(self, text: str) -> Report:
        read = read_models(
            [self._path],
            project_root=self._root,
            allow_outside=self._reading.allow_outside,
            projects=self._reading.projects,
            notations=NOTATIONS,
            contents={self._path: text.encode("utf-8")},
            cache=self._cache,
        )
        return check(read)

    def _rendered(self, model: Model, targets: Sequence[Target[Any]]) -> dict[str, str]:
        return {each.path: each.text for each in render(model, targets)}


def _outcome(mutation: Mutation, noticed_by: str, by: str, files: Sequence[str] = ()) -> Outcome:
    name = mutation.operator.name
    return Outcome(name, mutation.place, mutation.words, noticed_by, by, tuple(files))


def _key(finding: Diagnostic) -> tuple[str, str, str]:
    return finding.rule, finding.element, finding.message


def _told(finding: Diagnostic) -> str:
    return f"{finding.rule} {finding.message}"
