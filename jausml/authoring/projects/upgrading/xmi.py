"""Upgrades of XMI: namespaces and names of features change, and nothing else of the file."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.authoring.editing.splices import applied, merged
from jausml.authoring.editing.xmi.source import Source
from jausml.authoring.projects.upgrading.steps import (
    UpgradeError,
    new_name,
    steps_from,
    uri,
    version_of,
)
from jausml.language.model.documents import Document
from jausml.language.model.xmi.parsing import parse

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jausml.authoring.editing.splices import Splice
    from jausml.authoring.projects.upgrading.steps import Step
    from jausml.language.metamodel import ClassTable, Metamodels
    from jausml.language.model.xmi.parsing import Node

_TYPE = "http://www.w3.org/2001/XMLSchema-instance type"
_SEGMENT = re.compile(r"@([A-Za-z_]\w*)")


def upgraded_xmi(data: bytes, file: str, metamodels: Metamodels, steps: Sequence[Step]) -> bytes:
    """Returns a model in the present versions of its metamodels; the very bytes where it is.

    Args:
        data: The file.
        file: Its name.
        metamodels: The present metamodels.
        steps: The table of upgrades.

    Raises:
        UpgradeError: It cannot be read, or is of a version that no step begins with.
        EditError: Its encoding cannot be kept.
    """
    result = parse(data)
    if result.root is None or result.fault is not None:
        fault = result.fault
        place = f"{file}:{fault.line}:{fault.column}: " if fault is not None else f"{file}: "
        raise UpgradeError(f"{place}{fault.message if fault is not None else 'it is empty'}")
    work = _Work(data, file, result.encoding, metamodels)
    return work.upgraded(result.root, steps)


class _Work:
    """Work on one file."""

    def __init__(self, data: bytes, file: str, encoding: str, metamodels: Metamodels) -> None:
        document = Document(Path(file), file, is_library=False, given=True)
        document.data, document.encoding = data, encoding
        self._data = data
        self._file = file
        self._source = Source(document, file)
        self._metamodels = metamodels
        self._present = dict(filter(None, map(version_of, metamodels.packages)))
        self._steps: list[Step] = []
        self._old: dict[str, str] = {}

    def upgraded(self, root: Node, steps: Sequence[Step]) -> bytes:
        declared = _versions(root)
        languages = {language for language, _ in declared}
        # EMF declares only what it writes a type of: of the others the old names tell.
        self._steps += [step for step in steps if step.language not in languages]
        for language, version in sorted(declared):
            present = self._present.get(language)
            if present is not None and version != present:
                self._old[uri(language, version)] = uri(language, present)
                try:
                    self._steps += steps_from(language, version, present, steps)
                except UpgradeError as error:
                    before = self._data.replace(b"\0", b"").partition(
                        uri(language, version).encode()
                    )[0]
                    line = before.count(b"\n") + 1
                    raise UpgradeError(f"{self._file}:{line}: {error}") from error
        splices = [*self._namespaces(root), *self._names(root)]
        return applied(self._data, merged(splices)) if splices else self._data

    def _namespaces(self, root: Node) -> Iterator[Splice]:
        """Yields the changes of declared namespaces, and of what says where metamodels are."""
        pending = [root]
        while pending:
            node = pending.pop()
            pending += node.children
            for each in self._source.element(node).attributes:
                is_place = each.name.endswith(":schemaLocation")
                if not (is_place or each.name.startswith("xmlns")):
                    continue
                text = self._source.text[each.value : each.end]
                words = [self._old.get(word, word) for word in text.split(" ")]
                if " ".join(words) != text:
                    yield self._source.splice(each.value, each.end, " ".join(words))

    def _names(self, root: Node) -> Iterator[Splice]:
        if not any(step.renamed for step in self._steps):
            return
        tops = root.children if root.tag == "XMI" else [root]
        pending = [(each, self._class(each.namespace, each.tag)) for each in tops]
        while pending:
            node, table = pending.pop()
            yield from self._paths(node)
            if table is None:
                continue
            yield from self._attributes(node, table)
            for child in node.children:
                name = new_name(table, child.tag, self._steps)
                if name != child.tag:
                    yield from self._tags(child, name)
                feature = table.features.get(name)
                typed = child.get(_TYPE)
                target = feature.target if feature is not None else None
                if typed is not None:
                    prefix, _, simple = typed.rpartition(":")
                    target = self._class(child.prefixes.get(prefix, ""), simple)
                pending.append((child, target))

    def _class(self, namespace: str, name: str) -> ClassTable | None:
        package = self._metamodels.packages.get(self._old.get(namespace, namespace))
        return package.classes.get(name) if package is not None else None

    def _attributes(self, node: Node, table: ClassTable) -> Iterator[Splice]:
        for each in self._source.element(node).attributes:
            name = new_name(table, each.name, self._steps)
            if name != each.name:
                start = each.start + len(each.before)
                yield self._source.splice(start, start + len(each.name), name)

    def _tags(self, node: Node, name: str) -> Iterator[Splice]:
        element = self._source.element(node)
        begin = element.start + 1
        yield self._source.splice(begin, begin + len(element.name), name)
        if not element.is_empty:
            begin = element.inner_end + 2
            yield self._source.splice(begin, begin + len(element.name), name)

    def _paths(self, node: Node) -> Iterator[Splice]:
        """Yields the changes of paths by features, such as `//@bridges.0/@old.1`.

        A path says no classes. A name that no class has any more means the one that has it now.
        """
        renamed = self._unambiguous()
        for each in self._source.element(node).attributes:
            text = self._source.text[each.value : each.end]
            if "//@" not in text and not text.startswith("/"):
                continue
            new = _SEGMENT.sub(lambda match: f"@{renamed.get(match[1], match[1])}", text)
            if new != text:
                yield self._source.splice(each.value, each.end, new)

    def _unambiguous(self) -> Mapping[str, str]:
        present = {name for table in self._metamodels.classes.values() for name in table.features}
        renamed = (each for step in self._steps for each in step.renamed)
        return {each.old: each.new for each in renamed if each.old not in present}


def _versions(root: Node) -> set[tuple[str, tuple[int, int]]]:
    """Returns the metamodels and versions that a document declares."""
    found = set()
    pending = [root]
    while pending:
        node = pending.pop()
        pending += node.children
        found |= {each for each in map(version_of, node.prefixes.values()) if each is not None}
    return found
