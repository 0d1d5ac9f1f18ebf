"""Import statements of generated modules: exactly the names that the text below them uses."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from jausml.generation.literals import LINE_WIDTH

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

STANDARD = {
    "struct": ("struct",),
    "dataclasses": ("dataclass", "field"),
    "enum": ("IntEnum",),
    "typing": ("TYPE_CHECKING", "ClassVar"),
}
_WIRE = (
    "DecodeError EncodeError Message check_count check_presence exactly integer latin1 one_of"
    " padded real scaled scaled_down scaled_up sized take take_text unpadded whole whole_of"
)


def codec_names(runtime: str) -> dict[str, Sequence[str]]:
    """Returns what generated codecs may import of the runtime, by module.

    Args:
        runtime: The runtime package, e.g. `jausml_runtime`; empty in the runtime itself.
    """
    return {f"{runtime}.wire": _WIRE.split()}


def used_names(body: str) -> set[str]:
    """Returns the names that a Python text reads, those in annotations included.

    Args:
        body: The text of a module.
    """
    return {node.id for node in ast.walk(ast.parse(body)) if isinstance(node, ast.Name)}


def statements(body: str, *sections: Mapping[str, Sequence[str]]) -> str:
    """Returns the import statements that a module needs, in ruff's order.

    Args:
        body: The text below the imports.
        *sections: Names by module below those of the standard library: other packages first, the
            package itself last.
    """
    used = used_names(body)
    blocks = [_block(section, used) for section in (STANDARD, *sections)]
    return "\n\n".join(["from __future__ import annotations", *filter(None, blocks)])


def _block(modules: Mapping[str, Sequence[str]], used: set[str]) -> str:
    lines = []
    for module, offered in modules.items():
        names = [name for name in offered if name in used]
        if names == [module]:
            lines.append(f"import {module}")
        elif names:
            lines.append(from_import(module, names))
    return "\n".join(sorted(lines, key=lambda line: (line.startswith("from "), line.split()[1])))


def from_import(module: str, names: Iterable[str]) -> str:
    """Returns one import statement.

    Args:
        module: The module.
        names: What to import from it.
    """
    # Ruff sorts constants before classes before functions.
    ordered = sorted(names, key=lambda n: (0 if n.isupper() else 1 if n[0].isupper() else 2, n))
    line = f"from {module} import {', '.join(ordered)}"
    if len(line) <= LINE_WIDTH:
        return line
    return "\n".join([f"from {module} import (", *(f"    {name}," for name in ordered), ")"])
