"""Campaigns: the mutations of a model, each made, judged, generated and tested, in processes."""

from __future__ import annotations

import os
import random
import tempfile
import time
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from jausml.generation.errors import GenerationError
from jausml.generation.rendering import render
from jausml.generation.target import Target, load_targets
from jausml.generation.workspace import select
from jausml.language.metamodel import FeatureTable
from jausml.language.model import Diagnostic, Model, Severity
from jausml.language.model.reading.library_cache import LibraryCache
from jausml.language.model.xmi.printing import UnwritableError
from jausml.language.model.xmi.writer import to_xmi
from jausml.language.project import OneDocument
from jausml.language.semantics.paths.scopes import Placed, directed, directions_of
from jausml.language.semantics.subject import Subject
from jausml.language.validation.engine import check
from jausml.language.validation.rule import Report
from jausml.live.workers.pool import work_on
from jausml.mutating.broken_workspace import BrokenWorkspace
from jausml.mutating.changes import Change, Site, Together
from jausml.mutating.operators import OPERATORS, Operator
from jausml.mutating.oracles import ModelCheckOracle, ProofOracle
from jausml.mutating.outcomes import Outcome, Verdict

_SEED = 27


@dataclass(frozen=True, eq=False)
class Mutation:
    """One thing in a model that is broken."""

    operator: Operator
    place: str
    words: str
    change: Change | Together


def mutations(model: Model, names: Collection[str] = ()) -> list[Mutation]:
    """Returns the mutations of the elements of a model, without those of the library."""
    subject = Subject(model, [])
    placed: dict[Any, Placed[Any]] = {
        assignment.assignment: assignment
        for owner in directed(subject)
        for direction in directions_of(subject, owner)
        for assignment in direction.assignments
    }
    operators = [mutator for mutator in OPERATORS if not names or mutator.name in names]
    candidates = []
    for element in model.elements(library=False):
        for operator in operators:
            for table in _features(model, element, operator):
                site = Site(element, table, placed.get(element))
                place = model.element_path(element)
                for change in operator.changes(site):
                    candidates.append(Mutation(operator, place, change.words(), change))
    return candidates


def _features(model: Model, element: Any, operator: Operator) -> Iterator[FeatureTable]:
    table = model.metamodels.class_of(element)
    for name, features in operator.of_classes():
        if table in model.metamodels.classes[name].subtypes:
            yield from (table.features[feature] for feature in features)


def sample(candidates: Sequence[Mutation], limit: int) -> list[int]:
    """Returns the numbers of at most so many, spread over the operators, the same in each run."""
    if len(candidates) <= limit:
        return list(range(len(candidates)))
    chance = random.Random(_SEED)
    by_operator: dict[str, list[int]] = {}
    for number, mutation in enumerate(candidates):
        by_operator.setdefault(mutation.operator.name, []).append(number)
    for numbers in by_operator.values():
        chance.shuffle(numbers)
    chosen: list[int] = []
    while len(chosen) < limit:
        for numbers in by_operator.values():
            if numbers and len(chosen) < limit:
                chosen.append(numbers.pop())
    return sorted(chosen)


class CampaignError(Exception):
    """A campaign cannot run."""


@dataclass(frozen=True)
class Settings:
    """How a campaign runs.

    Attributes:
        budget: Seconds after which no further mutation is begun.
        command: What else tries the packages of a model, as arguments of a process.
    """

    names: tuple[str, ...]
    budget: float
    jobs: int
    command: tuple[str, ...] = ()


@dataclass(frozen=True)
class Tried:
    """The outcome of a mutation (`remarks`: which tests, proofs and checks could not take part)."""

    outcome: Outcome | None
    remarks: tuple[str, ...] = ()


def outcomes(
    document: OneDocument, chosen: Sequence[int], settings: Settings
) -> Iterator[tuple[int, Tried]]:
    """Yields the outcomes of mutations, in any order, by their place among the chosen ones."""
    if not hasattr(os, "fork"):
        raise CampaignError("mutations need a system that can fork, such as Linux")
    deadline = time.monotonic() + settings.budget
    shared = _Shared(document, settings.names, settings.command, deadline)
    yield from work_on(chosen, settings.jobs, _Breaker, shared)


@dataclass(frozen=True)
class _Shared:
    document: OneDocument
    names: tuple[str, ...]
    command: tuple[str, ...]
    deadline: float


class _Breaker:
    """Process that tries mutations of a model, one after another."""

    def __init__(self, shared: _Shared) -> None:
        self._shared = shared
        self._remarks: tuple[str, ...] = ()
        self._prepared: tuple[_Original, BrokenWorkspace, Sequence[Mutation]] | None = None

    def __call__(self, number: int) -> Tried:
        if time.monotonic() >= self._shared.deadline:
            return Tried(None)
        if self._prepared is None:
            self._prepared = self._prepare()
        original, workspace, possible = self._prepared
        outcome = original.outcome(possible[number], workspace)
        return Tried(outcome, (*self._remarks, *original.remarks))

    def _prepare(self) -> tuple[_Original, BrokenWorkspace, Sequence[Mutation]]:
        cache = LibraryCache()
        original = _Original(self._shared.document, cache)
        files = {**original.shared, **original.files}
        workspace = BrokenWorkspace(
            Path(tempfile.mkdtemp()),  # in the folder of the pool
            files,
            self._shared.command,
        )
        self._remarks = tuple(_prepared(workspace))
        return original, workspace, mutations(original.model, self._shared.names)


def _prepared(workspace: BrokenWorkspace) -> Iterator[str]:
    """Runs command and tests without a mutation, and yields those that cannot take part."""
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
    """A model as one document, with its generated files and its findings."""

    def __init__(self, document: OneDocument, cache: LibraryCache) -> None:
        self._document = document
        self._cache = cache
        # Its elements are changed: none may be shared with what is read again.
        self.model = document.read().model
        self._roots = [
            root
            for document in self.model.documents
            if not document.is_library
            for root in document.roots
        ]
        targets = select(load_targets()).targets
        self._targets = [target for target in targets if not target.is_shared]
        report = self._report(document.text)
        self._proof_oracle = ProofOracle(report)
        self._model_check_oracle = ModelCheckOracle(report.model)
        self._known = {_key(diagnostic) for diagnostic in report.diagnostics}
        if report.has_errors:
            raise CampaignError(f"the model as one XMI document: {report.diagnostics[0].message}")
        try:
            self.files = self._rendered(report.model, self._targets)
            self.shared = self._rendered(
                report.model, [target for target in targets if target.is_shared]
            )
        except GenerationError as error:
            raise CampaignError(f"nothing can be generated: {error}") from error

    @property
    def remarks(self) -> tuple[str, ...]:
        """The parts of the model that could not be proved or checked until now."""
        return (*self._proof_oracle.remarks, *self._model_check_oracle.remarks)

    def outcome(self, mutation: Mutation, workspace: BrokenWorkspace) -> Outcome:
        """Returns the outcome of a mutation."""
        undoing = mutation.change.apply()
        try:
            text = self._text()
        except UnwritableError as error:
            return _outcome(mutation, "validate", str(error))
        finally:
            undoing.apply()
        report = self._report(text)
        new = [
            diagnostic for diagnostic in report.diagnostics if _key(diagnostic) not in self._known
        ]
        errors = [diagnostic for diagnostic in new if diagnostic.severity is Severity.ERROR]
        if errors:
            return _outcome(mutation, "validate", _sentence(errors[0]))
        try:
            files = self._rendered(report.model, self._targets)
        except GenerationError as error:
            return _outcome(mutation, "generate", str(error))
        changed = workspace.differing({**self.shared, **files})
        failed = workspace.failing(files, changed) if changed else ""
        if failed:
            return _outcome(mutation, "tests", failed, changed)
        element = mutation.change.element
        finding = self._proof_oracle.new_finding(report, element) if changed else ""
        if finding:
            return _outcome(mutation, "prove", finding, changed)
        violation = self._model_check_oracle.new_violation(report.model) if changed else ""
        if violation:
            return _outcome(mutation, "check", violation, changed)
        refused = workspace.refusing(files, changed) if changed else ""
        if refused:
            return _outcome(mutation, "run", refused, changed)
        warnings = [diagnostic for diagnostic in new if diagnostic.severity is Severity.WARNING]
        if warnings:
            return _outcome(mutation, "warning", _sentence(warnings[0]), changed)
        if not changed:
            return _outcome(mutation, "equal", "", changed)
        return _outcome(mutation, "nothing", workspace.why_unseen(changed), changed)

    def _text(self) -> str:
        return to_xmi(self._roots, self.model, self._document.path)

    def _report(self, text: str) -> Report:
        return check(replace(self._document, text=text).read(self._cache))

    def _rendered(self, model: Model, targets: Sequence[Target[Any]]) -> dict[str, str]:
        return {artifact.path: artifact.text for artifact in render(model, targets)}


def _outcome(
    mutation: Mutation, verdict: Verdict, detail: str, files: Sequence[str] = ()
) -> Outcome:
    name = mutation.operator.name
    return Outcome(name, mutation.place, mutation.words, verdict, detail, tuple(files))


def _key(finding: Diagnostic) -> tuple[str, str, str]:
    return finding.rule, finding.element, finding.message


def _sentence(finding: Diagnostic) -> str:
    return f"{finding.rule} {finding.message}"
