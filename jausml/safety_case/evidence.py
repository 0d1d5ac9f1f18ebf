"""Evidence: files that say what was found of a model, and the tests that are generated of it."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Collection
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any

from lxml import etree

from jausml.generation.artifact import text_digest
from jausml.generation.rendering import render
from jausml.generation.target import system_of
from jausml.language.model.files import read_input
from jausml.language.model.model import Model
from jausml.language.semantics.paths.scopes import carriers_of
from jausml_generators.bridge.target import TARGET
from jausml_generators.python.names import snake_case

RULES, PROOF, MODEL_CHECK = "rules", "proof", "model check"
MUTATIONS, FAULT_RUNS, TEST_RUN = "mutations", "fault runs", "test run"

_KINDS = {
    PROOF: ("maps", {"name", "fields", "found"}),
    MODEL_CHECK: ("products", {"name", "complete", "found"}),
    MUTATIONS: ("outcomes", {"place", "change", "verdict"}),
}
"""Kinds of evidence in JSON: what lists their subjects, and what is told of each."""

_KNOWN = "results in JSON of prove, model-check, mutate or fault runs, or a JUnit report named .xml"
_LISTED = re.compile(r"^([0-9a-f]{64}) [ *]", re.MULTILINE)


class EvidenceError(Exception):
    """A file is no evidence that is known; the message says why."""


@dataclass(frozen=True)
class Evidence:
    """A piece of evidence.

    Attributes:
        path: Its file, relative to the folder of the case; empty for what was found just now.
        stale: Why it says nothing of the model as it is; empty for nothing.
    """

    id: str
    kind: str
    path: str = ""
    sha256: str = ""
    stale: str = ""
    content: dict[str, Any] = field(default_factory=dict, repr=False)


def read_evidence(file: Path, path: str, number: int, model: Collection[str]) -> Evidence:
    """Reads a file of evidence."""
    data = _data(file)
    digest = sha256(data).hexdigest()
    kind, content = _content(data, is_xml=file.suffix == ".xml")
    named = content.get("digests")
    digests = set(map(str, named.values())) if isinstance(named, dict) else set()
    beside = file.with_name(f"{file.name}.sha256")
    is_listed = os.path.exists(beside)  # noqa: PTH110 - for too long a name too
    listed = _LISTED.findall(_data(beside).decode("utf-8", "replace")) if is_listed else ()
    digests |= set(listed) if digest in listed else set()
    stale = "" if set(model) <= digests else "is of another version of the model"
    if not digests:
        stale = f"names no model: list the digests of both in {beside.name}, by sha256sum"
    return Evidence(f"E{number}", kind, path, digest, stale, content)


def _data(file: Path) -> bytes:
    try:
        return read_input(file)
    except FileNotFoundError as error:
        raise EvidenceError("is not there") from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise EvidenceError(f"cannot be read: {reason}") from error


def _content(data: bytes, *, is_xml: bool) -> tuple[str, dict[str, Any]]:
    if is_xml:
        return TEST_RUN, {"tests": _tests(data)}
    try:
        content = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise EvidenceError(f"is no JSON: {error}") from error
    for kind, (name, keys) in _KINDS.items():
        entries = content.get(name) if isinstance(content, dict) else None
        if isinstance(entries, list) and all(
            isinstance(entry, dict) and keys <= {*entry} for entry in entries
        ):
            return kind, content
    runs = content.get("faults") if isinstance(content, dict) else None
    if isinstance(runs, dict) and all(isinstance(run, dict) for run in runs.values()):
        return FAULT_RUNS, content
    raise EvidenceError(f"is no evidence that is known: {_KNOWN}")


_OUTCOMES = ("failure", "error", "skipped")
"""Outcomes of tests that are not passed, the worst first."""


def _tests(data: bytes) -> dict[str, str]:
    """Returns the worst outcomes of tests, by module and name: `passed`, or another word."""
    try:
        root = etree.fromstring(data, etree.XMLParser(resolve_entities=False, no_network=True))
    except etree.XMLSyntaxError as error:
        raise EvidenceError(f"is no JUnit report: {error}") from error
    outcomes_by_test: dict[str, str] = {}
    for case in root.iter("testcase"):
        module = case.get("classname", "").rpartition(".")[2]
        name = f"{module}.{case.get('name', '').partition('[')[0]}"
        outcomes = [outcomes_by_test.get(name), *(element.tag for element in case)]
        outcomes_by_test[name] = next(
            (outcome for outcome in _OUTCOMES if outcome in outcomes), "passed"
        )
    if not outcomes_by_test:
        raise EvidenceError("is no JUnit report: it has no test cases")
    return outcomes_by_test


_TEST = re.compile(r"^def test_(\w+)\(", re.MULTILINE)


@dataclass(frozen=True)
class GeneratedTests:
    """Tests of a bridge.

    Attributes:
        names: What stands behind the names of connections in those of tests, by connection.
    """

    path: str
    sha256: str
    owner: str
    names: dict[str, list[str]]


def generated_tests(model: Model) -> list[GeneratedTests]:
    """Returns the tests of the bridges of a model without errors."""
    tests = []
    artifacts = {
        rendered_artifact.element_id: rendered_artifact
        for rendered_artifact in render(model, [TARGET])
        if "/test/" in rendered_artifact.path
    }
    for owner in system_of(model).bridges:
        artifact = artifacts[f"bridge:{owner.name}"]
        names: dict[str, list[str]] = {
            snake_case(str(carrier.name)): [] for carrier in carriers_of(owner)
        }
        for test in _TEST.findall(artifact.text):
            known = (name for name in names if test == name or test.startswith(f"{name}_"))
            longest = max(known, key=len, default="")
            if longest:
                names[longest].append(test.removeprefix(longest))
        digest = text_digest(artifact.text)
        tests.append(GeneratedTests(artifact.path, digest, str(owner.name), names))
    return tests
