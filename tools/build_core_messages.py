#!/usr/bin/env python3
"""Writes jausml/runtime/messages.py from the core service set by our own generator.

Usage: python tools/build_core_messages.py [OUTPUT.py]
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.generation import FileTask, Target, Task, render
from jausml.language.metamodel.classes import jaus
from jausml.language.model import Model, read_models
from jausml_generators.python.codec.message_builder import build_messages
from jausml_generators.python.codec.messages import MessagesModule
from jausml_generators.python.package import PACKAGE_TEMPLATES

if TYPE_CHECKING:
    from collections.abc import Sequence

ROOT = Path(__file__).resolve().parent.parent
SOURCE = ROOT / "models" / "library" / "jaus" / "core-1.1.xmi"
OUTPUT = ROOT / "jausml" / "runtime" / "messages.py"


def tasks(model: Model) -> list[Task]:
    """Returns the one module with every message of the core services.

    Args:
        model: The core service set.
    """
    services = list(model.instances(jaus.Service))
    messages = [m for service in services for m in [*service.inputs, *service.outputs]]
    module = MessagesModule(
        summary="The messages of the JAUS core services (AS5710A) and their codecs.",
        runtime="",
        messages=build_messages(messages),
        source=SOURCE.name,
        element_id="core_messages",
    )
    return [
        FileTask(
            "messages.py.j2",
            [module],
            lambda _: OUTPUT.name,
            imports=lambda each: each.imports,
        )
    ]


TARGET = Target(
    name="core_messages",
    description="Codecs of the core messages, for the runtime itself.",
    tasks=tasks,
    template_folders=(PACKAGE_TEMPLATES,),
)


def build() -> str:
    """Returns the text of the module."""
    result = read_models([SOURCE])
    if result.diagnostics:
        raise ValueError("\n".join(map(str, result.diagnostics)))
    (artifact,) = render(result.model, [TARGET])
    return artifact.text


def main(arguments: Sequence[str]) -> int:
    """Runs the tool.

    Args:
        arguments: The output file, when it is another than the runtime's.

    Returns:
        The exit code.
    """
    path = Path(arguments[0]) if arguments else OUTPUT
    path.write_text(build(), encoding="utf-8", newline="\n")
    print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
