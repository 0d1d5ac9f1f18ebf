"""Modules of the runtime that generated code imports names from."""

from __future__ import annotations

import ast
import functools
from pathlib import Path
from typing import TYPE_CHECKING

import jausml
from jausml.generation.languages.python import Origin, offered

if TYPE_CHECKING:
    from collections.abc import Mapping

API_VERSION = (1, 0)
"""API of the runtime that generated code is written for."""

FACE = "jausml_runtime"
"""Components, bridges, and what they are made and told of."""
MESSAGES = f"{FACE}.messages"
"""Messages of the core services."""
CONVERSIONS = f"{FACE}.conversions"
"""Conversions of values, and the values that they know."""
ARITHMETIC = f"{CONVERSIONS}.arithmetic"
"""Functions of expressions."""
COLUMNS = f"{CONVERSIONS}.columns"
"""Columns of numbers, by numpy."""
LIGHT = f"{FACE}.bridge.light_message"
"""What light classes of ROS messages are made of."""
OCTETS = f"{FACE}.bridge.messages.octets"
"""Lists of single octets."""
WIRE = f"{FACE}.wire"
"""What classes of messages are made of."""


@functools.cache
def names() -> Mapping[str, Origin]:
    """Returns what generated modules may import of the runtime besides messages and codecs.

    The face is read from the file that is copied: nothing that generates imports the runtime.
    """
    face = Path(jausml.__file__).parent / "runtime" / "__init__.py"
    lists = [
        node.value
        for node in ast.parse(face.read_text("utf-8")).body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"
    ]
    return {
        **offered(FACE, *ast.literal_eval(lists[0])),
        "conversions": Origin(FACE, "conversions"),
        "arithmetic": Origin(CONVERSIONS, "arithmetic"),
        "columns": Origin(CONVERSIONS, "columns"),
        "octets": Origin(f"{FACE}.bridge.messages", "octets"),
    }
