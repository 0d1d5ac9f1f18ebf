"""Declaration of the messages of Figure 5 that nobody knows: those of JAUS and those of ROS."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from jausml.language.model.uris import library_root
from jausml.language.text.reading.declarations.messages import OwnService
from jausml.language.text.reading.declarations.ros import RosFields
from jausml.language.text.reading.declarations.types import Types
from jausml.language.text.root_names import package_name

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from jausml.language.metamodel import Metamodels
    from jausml.language.model.notation import Known
    from jausml.language.model.xmi.parsing import Node
    from jausml.language.text.reading.elements import ElementReader
    from jausml.language.text.reading.maps import WrittenEnd
    from jausml.language.text.reading.nodes import NodeMaker
    from jausml.language.text.tree import End, Member

_NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")


class Declarer:
    """Declares the new messages of one document."""

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
        self.service = OwnService(metamodels, nodes, elements, path, self.types)
        self._ros = RosFields(metamodels, nodes, elements, self.types)
        self._packages: dict[str, Node] = {}
        self.roots: list[Node] = []
        self._declaring: set[int] = set()
        self._fresh: dict[tuple[bool, str], WrittenEnd] = {}

    def run(self, ends: Sequence[WrittenEnd], known: Known) -> None:
        """Declares what ends with members name in vain, each once."""
        fresh: dict[tuple[bool, str], WrittenEnd] = {}
        for written in ends:
            end = written.end
            if end.members is not None and self._is_new(end, known):
                fresh.setdefault((end.is_jaus, end.type.text), written)
        self._declaring = {id(written.end) for written in fresh.values()}
        self._fresh = fresh
        messages = [each for (is_jaus, _), each in fresh.items() if is_jaus]
        self.roots += self.service.declare(messages, known)
        for (is_jaus, _), written in fresh.items():
            if not is_jaus:
                self._message_type(written.end)

    def declares(self, end: End) -> bool:
        """Tells whether an end declares its message."""
        return id(end) in self._declaring

    def declaration_of(self, written: WrittenEnd) -> WrittenEnd | None:
        """Returns the end that declares the message or type of an end, None where it is known."""
        return self._fresh.get((written.end.is_jaus, written.end.type.text))

    def _is_new(self, end: End, known: Known) -> bool:
        package, _, name = end.type.text.replace("/msg/", "/").rpartition("/")
        if end.is_jaus:
            package, name = "", end.type.text
        is_shipped = bool(package) and (library_root() / "ros" / f"{package}.xmi").is_file()
        if not _NAME.fullmatch(name) or is_shipped:
            return False
        kind = "jaus.MessageDef" if end.is_jaus else "ros.MessageType"
        return not known.find(kind, end.type.text)

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
