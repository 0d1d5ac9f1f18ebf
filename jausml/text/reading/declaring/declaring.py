"""Declaration of the messages of Figure 5 that nobody knows: those of JAUS and those of ROS."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from jausml.model.uris import LIBRARY_URI, library_root
from jausml.text.reading.declaring.common import Types
from jausml.text.reading.declaring.jaus import JausFields
from jausml.text.reading.declaring.ros import RosFields
from jausml.text.root_names import package_name, service_name, system_name

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from jausml.metamodel import Metamodels
    from jausml.model.notation import Known
    from jausml.model.xmi.parsing import Node
    from jausml.text.reading.elements import ElementReader
    from jausml.text.reading.maps import WrittenEnd
    from jausml.text.reading.nodes import NodeMaker
    from jausml.text.tree import End, Member

FIRST_CODE = 0xD000
LAST_CODE = 0xFFFF

MANAGEMENT = f"{LIBRARY_URI}jaus/core-1.1.xmi#Management"
"""What a service with commands inherits: only so can it tell its controller from strangers."""

_NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")


class Declarer:
    """Declares the new messages of one document.

    Args:
        metamodels: The metamodels of the elements.
        nodes: Makes the nodes.
        elements: Reads features.
        path: The file, which gives names to the roots.
        types: The named types of the text.
    """

    def __init__(
        self,
        metamodels: Metamodels,
        nodes: NodeMaker,
        elements: ElementReader,
        path: Path,
        types: Mapping[str, Member],
    ) -> None:
        self._classes = metamodels.classes
        self._nodes = nodes
        self._elements = elements
        self._path = path
        self.types = Types(types)
        self._jaus = JausFields(metamodels, nodes, elements, self.types)
        self._ros = RosFields(metamodels, nodes, elements, self.types)
        self._packages: dict[str, Node] = {}
        self.roots: list[Node] = []
        self._declaring: set[int] = set()

    def run(self, ends: Sequence[WrittenEnd], known: Known) -> None:
        """Declares what ends with members name in vain, each once.

        Args:
            ends: The ends of all maps, in the order of the text.
            known: What is known already.
        """
        fresh: dict[tuple[bool, str], WrittenEnd] = {}
        for written in ends:
            end = written.end
            if end.members is not None and self._is_new(end, known):
                fresh.setdefault((end.is_jaus, end.type.text), written)
        self._declaring = {id(written.end) for written in fresh.values()}
        self._messages([each for (is_jaus, _), each in fresh.items() if is_jaus], known)
        for (is_jaus, _), written in fresh.items():
            if not is_jaus:
                self._message_type(written.end)

    def declares(self, end: End) -> bool:
        """Tells whether an end declares its message."""
        return id(end) in self._declaring

    def _is_new(self, end: End, known: Known) -> bool:
        package, _, name = end.type.text.replace("/msg/", "/").rpartition("/")
        if end.is_jaus:
            package, name = "", end.type.text
        is_shipped = bool(package) and (library_root() / "ros" / f"{package}.xmi").is_file()
        if not _NAME.fullmatch(name) or is_shipped:
            return False
        kind = "jaus.MessageDef" if end.is_jaus else "ros.MessageType"
        return not known.find(kind, end.type.text)

    def _messages(self, ends: Sequence[WrittenEnd], known: Known) -> None:
        if not ends:
            return
        first = ends[0].end.type.span
        root = self._nodes.root(self._classes["jaus.ServiceSet"], first)
        self.roots.append(root)
        self._nodes.value(root, "name", system_name(self._path), first)
        table = self._classes["jaus.Service"]
        service = self._nodes.element(root, "services", table, first)
        name = service_name(self._path)
        self._nodes.value(service, "name", name, first)
        self._nodes.value(service, "urn", f"urn:jausml:{system_name(self._path)}:{name}", first)
        command = next((each.end for each in ends if is_command(each.end)), None)
        if command is not None:
            self._nodes.href(service, "inherits", MANAGEMENT, command.type.span)
        used = known.message_codes() | {code for each in ends if (code := stated_code(each.end))}
        for written in ends:
            self._message(service, written, used, known)

    def _message(self, service: Node, written: WrittenEnd, used: set[int], known: Known) -> None:
        end = written.end
        table = self._classes["jaus.MessageDef"]
        node = self._nodes.element(service, message_feature(written), table, end.span)
        self._nodes.value(node, "name", end.type.text, end.type.span)
        self._elements.document(node, end)
        self._elements.items(node, end.features)
        if not any(each.name.text == "code" for each in end.features):
            self._assign_code(node, end, used, known)
        if end.members:
            self._jaus.body(node, end)

    def _assign_code(self, node: Node, end: End, used: set[int], known: Known) -> None:
        name, span = end.type.text, end.type.span
        free = next((code for code in range(FIRST_CODE, LAST_CODE + 1) if code not in used), None)
        if free is None:
            message = f"no code is left for the new message '{name}'"
            self._nodes.fault("JML712", span, message, owner=node, feature="code")
            return
        used.add(free)
        code = f"0x{free:04X}"
        self._nodes.value(node, "code", code, span)
        near = known.alike("jaus.MessageDef", name)
        hint = f"state it: {{ code: {code} }}"
        hint += f"; or did you mean '{near[0]}'?" if near else ""
        self._nodes.fault("JML711", span, f"new message '{name}' has the code {code}", hint)

    def _message_type(self, end: End) -> None:
        package, _, name = end.type.text.replace("/msg/", "/").rpartition("/")
        root = self._package(package or package_name(self._path), end)
        self._ros.message(root, name, end)

    def _package(self, name: str, end: End) -> Node:
        root = self._packages.get(name)
        if root is None:
            table = self._classes["ros.InterfacePackage"]
            root = self._packages[name] = self._nodes.root(table, end.type.span)
            self._nodes.value(root, "name", name, end.type.span)
            self.roots.append(root)
        return root


def message_feature(written: WrittenEnd) -> str:
    """Returns whether a new message goes into its service or comes out of it.

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
        each.name.text == "isCommand" and [getattr(v, "text", "") for v in each.values] == ["true"]
        for each in end.features
    )


def stated_code(end: End) -> int | None:
    """Returns the code that an end states for its message, None for none or for no number."""
    texts = [
        getattr(v, "text", "") for f in end.features if f.name.text == "code" for v in f.values
    ]
    match = re.fullmatch("0x([0-9A-Fa-f]{4})", texts[0]) if texts else None
    return int(match[1], 16) if match else None
