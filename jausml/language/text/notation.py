"""ros2jaus text as a notation of models."""

from __future__ import annotations

import codecs
from typing import TYPE_CHECKING

from jausml.language.metamodel import FeatureKind
from jausml.language.model import conflicts
from jausml.language.model.notation import Fault, Notation
from jausml.language.text.keywords import snake_case
from jausml.language.text.rules import TEXT_RULES

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from jausml.language.metamodel import ClassTable, FeatureTable, Metamodels
    from jausml.language.model.rules import RuleInfo
    from jausml.language.text.reading.bridge_of_maps import BridgeOfMaps
    from jausml.language.text.reading.document import TextDocument
    from jausml.language.text.reading.parsing import Parsed

SUFFIX = ".ros2jaus"

_SPECIAL = {
    "source": "source -> target",
    "target": "source -> target",
    "assignments": "list -> list { source -> target }",
    "AttributeMap.message": "JAUS Message",
    "AttributeMap.type": "ROS package/Type",
}
"""How features are given that have a notation of their own, by name or by class and name."""

_VALUES = {
    "EString": "text",
    "EInt": "number",
    "ELong": "number",
    "EDouble": "number",
    "EDoubleObject": "number",
}


class Ros2Jaus:
    """Reads ros2jaus text.

    Args:
        parse: Parses a text; one that remembers spares parsing what was parsed.
    """

    def __init__(
        self,
        bridge: BridgeOfMaps | None = None,
        parse: Callable[[str], Parsed] | None = None,
    ) -> None:
        self._bridge = bridge
        self._parse = parse

    @property
    def suffixes(self) -> tuple[str, ...]:
        """The ending of the files."""
        return (SUFFIX,)

    @property
    def rules(self) -> Mapping[str, RuleInfo]:
        """The rules of its findings."""
        return TEXT_RULES

    def how_to_give(self, table: ClassTable, feature: FeatureTable) -> str:
        """Returns how a feature of a class is given a value."""
        if feature.name == "name":
            return f"write '{snake_case(table.name)} <name>'"
        special = _SPECIAL.get(f"{table.name}.{feature.name}") or _SPECIAL.get(feature.name)
        return f"write '{special or _usual(feature)}'"

    def read(self, data: bytes, path: Path, metamodels: Metamodels) -> TextDocument:
        """Reads a document, as `jausml.language.model.notation.Notation` says."""
        # All this takes a while to load, and models in XMI do without it.
        from jausml.language.text.reading.document import TextDocument  # noqa: PLC0415
        from jausml.language.text.reading.parsing import parse  # noqa: PLC0415
        from jausml.language.text.tree import SyntaxTree  # noqa: PLC0415

        text, fault = decode(data)
        if fault is not None:
            return TextDocument(SyntaxTree(), [fault], path, metamodels)
        parsed = (self._parse or parse)(text)
        conflict, first = conflicts.unmerged(data) if parsed.faults else ("", 0)
        if conflict:
            fault = Fault(conflicts.RULE, conflict, conflicts.HINT, first)
            return TextDocument(SyntaxTree(), [fault], path, metamodels)
        faults = [
            Fault("JML701", each.message, each.hint, each.span.line, each.span.column)
            for each in parsed.faults
        ]
        bridge = self._bridge if self._bridge is not None and self._bridge.path == path else None
        return TextDocument(parsed.document, faults, path, metamodels, bridge)


NOTATIONS: tuple[Notation, ...] = (Ros2Jaus(),)
"""The notations besides XMI that the toolchain reads."""


def decode(data: bytes) -> tuple[str, Fault | None]:
    """Returns the text of a file; or an empty text, and why the file is none."""
    if not data.removeprefix(codecs.BOM_UTF8):
        hint = "write a component, a bridge or a map, or remove the file"
        return "", Fault("JML714", "the file is empty", hint)
    try:
        return data.decode("utf-8-sig"), None
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8-sig", errors="replace")
        line = before.count("\n") + 1
        column = len(before) - (before.rfind("\n") + 1) + 1
        message = f"the file is not UTF-8 text: byte 0x{data[error.start]:02x}"
        return "", Fault("JML714", message, "save it as UTF-8", line, column)


def _usual(feature: FeatureTable) -> str:
    target = feature.target
    if target is None:
        return f"{feature.name}: <{_VALUES.get(feature.type_name, feature.type_name)}>"
    if feature.kind is not FeatureKind.CONTAINMENT:
        return f"{feature.name}: <name of a {target.name}>"
    if target.abstract:
        return f"{feature.name}: new ... {{ }}"
    if not feature.many:
        return f"{feature.name}: {{ }}"
    name = " name" if "name" in target.features else ""
    return f"{snake_case(target.name)}{name or ' { }'}"
