"""The code that `jausml generate` makes of the bridges of a model, in memory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.artifact import text_digest
from jausml.generation.checks import find_problems
from jausml.generation.errors import GenerationError
from jausml.generation.rendering import render
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.messages.target import TARGET as MESSAGES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.model import Model


@dataclass(frozen=True)
class BridgeCode:
    """The generated code of bridges.

    Attributes:
        files: The Python files by path, relative to the folder of the workspace.
        digest: What tells them from others.
    """

    files: Mapping[str, str]
    digest: str


def bridge_code(model: Model) -> BridgeCode:
    """Returns the generated code of the bridges of a model, without the runtime.

    Args:
        model: A model without errors.

    Raises:
        GenerationError: It has what cannot be generated.
    """
    made = render(model, (BRIDGE, MESSAGES))
    problems = find_problems(made)
    if problems:
        raise GenerationError(next(iter(problems.values())))
    files = {
        each.path: each.text
        for each in made
        if each.path.endswith(".py") and each.path.count("/") == 2 and "/test/" not in each.path
    }
    digest = text_digest("\n".join(f"{path}\n{text}" for path, text in sorted(files.items())))
    return BridgeCode(files, digest)
