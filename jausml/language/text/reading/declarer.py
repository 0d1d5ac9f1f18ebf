"""Declares the new JAUS messages and ROS types whose members the maps of a text list."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from jausml.language.model.library import has_package
from jausml.language.model.notation import Known
from jausml.language.model.xmi.parsing import Node
from jausml.language.semantics.names import package_name, words
from jausml.language.text.reading import declared_types
from jausml.language.text.reading.declared_messages import OwnService
from jausml.language.text.reading.elements import ElementReader
from jausml.language.text.reading.maps import WrittenEnd
from jausml.language.text.tree import End, Feature, Member, Name

_NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")


class Declarer:
    """Declares the new messages of one document."""

    def __init__(self, elements: ElementReader, path: Path, types: Mapping[str, Member]) -> None:
        self._nodes = elements.nodes
        self._path = path
        self.types = declared_types.Types(types)
        self.service = OwnService(elements, path, self.types)
        self._ros = RosFields(elements, self.types)
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
                # The first end of a name declares it; later ones are checked against that.
                fresh.setdefault((end.is_jaus, end.type.text), written)
        self._declaring = {id(written.end) for written in fresh.values()}
        self._fresh = fresh
        messages = [written_end for (is_jaus, _), written_end in fresh.items() if is_jaus]
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
        # In a package that is known, a type that it lacks is an error and nothing new.
        if not _NAME.fullmatch(name) or has_package(package):
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
            table = self._nodes.metamodels.classes["ros.InterfacePackage"]
            root = self._packages[name] = self._nodes.root(table, end.type.span)
            self._nodes.value(root, "name", name, end.type.span)
            self.roots.append(root)
        return root


_PRIMITIVES = declared_types.NUMBERS | {declared_types.BOOL, declared_types.STRING, "wstring"}
_LIMITS = {"lower": "minimum", "upper": "maximum"}


class RosFields(declared_types.MemberBuilder):
    """Builds new ROS types."""

    def message(self, package: Node, name: str, end: End) -> None:
        """Adds the type of an end to a package, with types of its own for its structs."""
        node = self.new(package, "messages", "ros.MessageType", end.span)
        self.nodes.value(node, "name", name, end.type.span)
        self.elements.document(node, end)
        self.elements.items(node, end.features)
        self._fields(package, node, name, end.members or [])

    def _fields(self, package: Node, node: Node, name: str, members: Sequence[Member]) -> None:
        for member in self.named(members):
            if not self.is_too_much(member):
                self._field(package, node, name, member)

    def _field(self, package: Node, node: Node, type_name: str, member: Member) -> None:
        definition, size = self._resolved(member)
        if definition is None or member.name is None:
            return
        if isinstance(definition.type, list):
            is_named = definition is not member
            # A named type is one ROS type for all; a struct without a name is one for its member.
            if is_named and definition.name is not None:
                inner = _camel(definition.name.text)
            else:
                inner = type_name + _camel(member.name.text)
            if not self._struct(package, inner, definition, is_named=is_named):
                return
            field = self.new(node, "fields", "ros.MessageField", member.span)
            path = f"{_name_of(package)}.{inner}"
            self.nodes.name(field, "messageType", path, member.span)
        else:
            field = self._typed(node, definition.type, member)
        self.nodes.value(field, "name", member.name.text, member.name.span)
        self._size(field, size, member)
        self.elements.document(field, member)
        self.elements.items(field, [_limited(feature) for feature in member.features])

    def _typed(self, node: Node, type_: Name, member: Member) -> Node:
        word = declared_types.type_word(type_.text)
        if word.word not in _PRIMITIVES:
            field = self.new(node, "fields", "ros.MessageField", member.span)
            self.nodes.name(field, "messageType", type_.text, type_.span)
            return field
        field = self.new(node, "fields", "ros.PrimitiveField", member.span)
        self._primitive(field, word, type_)
        return field

    def _primitive(self, field: Node, word: declared_types.TypeWord, type_: Name) -> None:
        self.nodes.value(field, "type", word.word, type_.span)
        if word.bound:
            self.nodes.value(field, "stringBound", str(word.bound), type_.span)

    def _size(self, field: Node, size: declared_types.Size | None, member: Member) -> None:
        if size is None:
            return
        kind = "fixedArray" if size.is_fixed else "boundedSequence"
        kind = kind if size.count else "unboundedSequence"
        self.nodes.value(field, "arrayKind", kind, member.span)
        if size.count:
            self.nodes.value(field, "arraySize", str(size.count), member.span)

    def _resolved(self, member: Member) -> tuple[Member | None, declared_types.Size | None]:
        """Returns the member that defines the type of another, or that one itself, and its size."""
        if self.is_wrong_size(member):
            return None, None
        size = declared_types.size_of(member)
        definition = member
        seen: set[str] = set()
        while isinstance(definition.type, Name) and definition.type.text in self.types.named:
            word = definition.type
            self.types.used.add(word.text)
            if word.text in seen:
                message = f"type '{word.text}' contains itself"
                self.nodes.fault("JML712", word.span, message)
                return None, None
            seen.add(word.text)
            definition = self.types.named[word.text]
            if self.is_wrong_size(definition):
                return None, None
            inner = declared_types.size_of(definition)
            if size is not None and inner is not None:
                message = f"'{word.text}' is an array already: ROS has no arrays of arrays"
                self.nodes.fault("JML712", member.span, message)
                return None, None
            size = size or inner
        return definition, size

    def _struct(self, package: Node, name: str, member: Member, *, is_named: bool) -> bool:
        """Adds the type of a struct to a package; tells, after a report, when it cannot.

        A named type that is there already is not added again.
        """
        there = any(_name_of(child) == name for child in package.children)
        if (there and is_named) or not isinstance(member.type, list):
            return True
        if len(self.types.open) >= declared_types.DEEPEST:
            message = f"named types are nested more than {declared_types.DEEPEST} deep"
            self.nodes.fault("JML712", member.span, message)
            return False
        node = self.new(package, "messages", "ros.MessageType", member.span)
        self.nodes.value(node, "name", name, member.span)
        self.types.open.append(name)
        self._fields(package, node, name, member.type)
        self.types.open.pop()
        return True


def _limited(item: Feature) -> Feature:
    """Returns a feature with the word that ROS has for a limit."""
    word = _LIMITS.get(item.name.text)
    return item if word is None else replace(item, name=Name(word, item.name.span))


def _camel(name: str) -> str:
    return "".join(word[0].upper() + word[1:] for word in words(name))


def _name_of(node: Node) -> str:
    return next((child.text for child in node.children if child.tag == "name"), "")
