"""The service of the JAUS messages that a text declares, with their codes and queries."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from jausml.language.model.library import LIBRARY_URI
from jausml.language.model.notation import Known
from jausml.language.model.xmi.parsing import Node
from jausml.language.semantics.names import service_name, snake_case, system_name
from jausml.language.text.reading.declared_types import JausFields, Types
from jausml.language.text.reading.elements import ElementReader
from jausml.language.text.reading.maps import WrittenEnd
from jausml.language.text.tree import Element, End, Feature, Span

FIRST_CODE = 0xD000
LAST_CODE = 0xFFFF

MANAGEMENT = f"{LIBRARY_URI}jaus/core-1.1.xmi#Management"
"""The service that one with commands inherits, to tell its controller from strangers."""

_REPORT, _QUERY = "Report", "Query"


class OwnService:
    """Makes the service that has the new messages of a text."""

    def __init__(self, elements: ElementReader, path: Path, types: Types) -> None:
        self._nodes = elements.nodes
        self._classes = self._nodes.metamodels.classes
        self._elements = elements
        self._path = path
        self._fields = JausFields(elements, types)
        self._used: set[int] = set()
        self.asks_for_all = False
        """Whether every message that comes out of the service gets a query, not reports alone."""
        self.written: Element | None = None
        """The service as the text writes it, if it does."""
        self.node: Node | None = None
        """The service, once it has messages."""

    @property
    def name(self) -> str:
        """The name of the service: that of the text, or else one after the file."""
        if self.written is not None and self.written.name is not None:
            return self.written.name.text
        return service_name(self._path)

    def declare(self, ends: Sequence[WrittenEnd], known: Known) -> list[Node]:
        """Returns the service set of the service, which is there if the text needs or writes it."""
        if self.written is None and not ends:
            return []
        span = self.written.span if self.written is not None else ends[0].end.type.span
        root = self._nodes.root(self._classes["jaus.ServiceSet"], span)
        self._nodes.value(root, "name", system_name(self._path), span)
        service = self._service(root, span, ends)
        # All codes that are stated anywhere, before the first free one is given away.
        self._used = known.message_codes() | set(self._stated_codes(ends))
        for written in ends:
            self._message(service, written, known)
        # After all messages: a query that the text declares itself needs no second one.
        for written in ends:
            self._query(service, written, known)
        self.node = service
        return [root]

    def _service(self, root: Node, span: Span, ends: Sequence[WrittenEnd]) -> Node:
        table = self._classes["jaus.Service"]
        service = self._nodes.element(root, "services", table, span, self.written)
        scope = system_name(self._path)
        if self.written is not None:
            self._elements.fill(service, self.written)
            scope = snake_case(self.name)
        else:
            self._nodes.value(service, "name", self.name, span)
        stated = {child.tag for child in service.children}
        if "urn" not in stated:
            self._nodes.value(service, "urn", f"urn:jausml:{scope}:{self.name}", span)
        command = next((end.end for end in ends if is_command(end.end)), None)
        if command is not None and "inherits" not in stated:
            self._nodes.href(service, "inherits", MANAGEMENT, command.type.span)
        return service

    def _message(self, service: Node, written: WrittenEnd, known: Known) -> None:
        end = written.end
        table = self._classes["jaus.MessageDef"]
        node = self._nodes.element(service, message_feature(written), table, end.span)
        self._nodes.value(node, "name", end.type.text, end.type.span)
        self._elements.document(node, end)
        self._elements.items(node, end.features)
        if not any(feature.name.text == "code" for feature in end.features):
            near = known.alike("jaus.MessageDef", end.type.text)
            code = self._assign_code(node, end.type.text, end.type.span)
            hint = f"state it: {{ code: {code} }}"
            hint += f"; or did you mean '{near[0]}'?" if near else ""
            self._tell_code(end.type.text, code, hint, end.type.span)
        if end.members:
            self._fields.body(node, end)

    def _query(self, service: Node, written: WrittenEnd, known: Known) -> None:
        """Adds the query that asks for a report, unless it is known or declared itself."""
        report, span = written.end.type.text, written.end.type.span
        name = f"{_QUERY}{report.removeprefix(_REPORT)}"
        declared = {child.text for branch in service.children for child in branch.children}
        is_report = report.startswith(_REPORT) or self.asks_for_all
        if not is_report or message_feature(written) != "outputs" or name in declared:
            return
        if known.find("jaus.MessageDef", name):
            return
        node = self._nodes.element(service, "inputs", self._classes["jaus.MessageDef"], span)
        self._nodes.value(node, "name", name, span)
        code = self._assign_code(node, name, span)
        hint = (
            f"state it: service {self.name} {{ inputs: new message_def {name} {{ code: {code} }} }}"
        )
        self._tell_code(name, code, hint, span)

    def _assign_code(self, node: Node, name: str, span: Span) -> str:
        codes = range(FIRST_CODE, LAST_CODE + 1)
        free = next((code for code in codes if code not in self._used), None)
        if free is None:
            message = f"no code is left for the new message '{name}'"
            self._nodes.fault("JML712", span, message, owner=node, feature="code")
            return ""
        self._used.add(free)
        code = f"0x{free:04X}"
        self._nodes.value(node, "code", code, span)
        return code

    def _tell_code(self, name: str, code: str, hint: str, span: Span) -> None:
        if code:
            self._nodes.fault("JML711", span, f"new message '{name}' has the code {code}", hint)

    def _stated_codes(self, ends: Sequence[WrittenEnd]) -> Iterator[int]:
        items = self.written.items if self.written is not None else []
        features = [item for item in items if isinstance(item, Feature)]
        blocks = [
            value for feature in features for value in feature.values if isinstance(value, Element)
        ]
        of_messages = [
            [feature for feature in block.items if isinstance(feature, Feature)] for block in blocks
        ]
        for facts in [*(end.end.features for end in ends), *of_messages]:
            code = stated_code(facts)
            if code is not None:
                yield code


def message_feature(written: WrittenEnd) -> str:
    """Returns the feature of its service that gets a new message: inputs or outputs.

    Queries and commands go in, reports come out; another message goes the way of its map: what
    becomes ROS comes out of the service, what is made of ROS goes in.
    """
    end = written.end
    name = end.type.text
    if is_command(end) or name.startswith(("Query", "Set")):
        return "inputs"
    directions = {child.tag for child in written.node.children}
    is_sent = "toJaus" in directions and "toRos" not in directions
    return "inputs" if is_sent and not name.startswith("Report") else "outputs"


def is_command(end: End) -> bool:
    """Tells whether an end declares a command."""
    return any(
        feature.name.text == "isCommand"
        and [getattr(value, "text", "") for value in feature.values] == ["true"]
        for feature in end.features
    )


def stated_code(features: Sequence[Feature]) -> int | None:
    """Returns the code that features state for a message, None for none or for no number."""
    texts = [
        getattr(value, "text", "")
        for feature in features
        if feature.name.text == "code"
        for value in feature.values
    ]
    match = re.fullmatch("0x([0-9A-Fa-f]{4})", texts[0]) if texts else None
    return int(match[1], 16) if match else None
