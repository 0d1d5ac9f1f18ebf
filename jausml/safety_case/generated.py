"""The tests that are generated of a model, by what they test."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.artifact import text_digest
from jausml.generation.rendering import render
from jausml.generation.system import system_of
from jausml_generators.bridge.target import TARGET
from jausml_generators.python.names import snake_case

if TYPE_CHECKING:
    from jausml.language.model.model import Model

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
    """Returns the tests of the bridges of a model without errors.

    Raises:
        GenerationError: Nothing can be generated of the model.
    """
    found = []
    artifacts = {each.element_id: each for each in render(model, [TARGET]) if "/test/" in each.path}
    for owner in system_of(model).bridges:
        artifact = artifacts[f"bridge:{owner.name}"]
        carriers = (*owner.bridgeConnections, *owner.serviceConnections, *owner.actionConnections)
        names: dict[str, list[str]] = {snake_case(str(each.name)): [] for each in carriers}
        for test in _TEST.findall(artifact.text):
            known = (e for e in names if test == e or test.startswith(f"{e}_"))
            longest = max(known, key=len, default="")
            if longest:
                names[longest].append(test.removeprefix(longest))
        digest = text_digest(artifact.text)
        found.append(GeneratedTests(artifact.path, digest, str(owner.name), names))
    return found
