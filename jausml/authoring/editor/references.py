"""Completions of references to services and maps, those of the library included."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import jaus
from jausml.language.model.names import qualified_name
from jausml.language.semantics.services import with_inherited
from jausml.language.text.reading.library_maps import library_maps
from jausml.language.text.tree import Element, Feature, Import, Name

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from jausml.authoring.editor.context import Context
    from jausml.authoring.editor.workbench import Workbench


@dataclass(frozen=True, slots=True)
class Candidate:
    """An element that a reference can name.

    Attributes:
        module: What the text must import first, empty when it knows the name.
    """

    name: str
    detail: str
    module: str = ""
    fits: bool = False


def services(bench: Workbench, path: Path) -> Iterator[Candidate]:
    """Yields the services that a text can name.

    Those that the library has in several versions need an import that says which.
    """
    imported = _imported(bench, path)
    named: dict[str, list[jaus.Service]] = {}
    for each in bench.elements(path, jaus.Service):
        named.setdefault(each.name or "", []).append(each)
    for name, found in named.items():
        modules = [bench.module_of(each) for each in found] if len(found) > 1 else [""]
        known = [each for each in zip(found, modules, strict=True) if each[1] in {"", *imported}]
        for service, module in known[:1] or zip(found, modules, strict=True):
            detail = f"{qualified_name(service)} {service.version or ''}".strip()
            yield Candidate(name, detail, "" if known else module)


def maps(bench: Workbench, path: Path, context: Context) -> Iterator[Candidate]:
    """Yields the maps of the library for a connection: first those of its services."""
    imported = _imported(bench, path)
    wanted = _messages_around(bench, path, context)
    for each in library_maps():
        module = "" if each.module in imported else each.module
        detail = f"{each.message}, {each.type}"
        yield Candidate(each.name, detail, module, each.message in wanted)


def _imported(bench: Workbench, path: Path) -> set[str]:
    items = bench.tree(path).items
    return {
        each.target.text
        for each in items
        if isinstance(each, Import) and isinstance(each.target, Name)
    }


def _messages_around(bench: Workbench, path: Path, context: Context) -> set[str]:
    """Returns the names of the messages that the bridge and its peers have around a place."""
    blocks = [each.item for each in context.levels if isinstance(each.item, Element)]
    named = {name for block in blocks for name in _values(block, ("provides", "uses", "services"))}
    peers = {name for block in blocks for name in _values(block, ("peers",))}
    for item in bench.tree(path).items:
        if isinstance(item, Element) and item.name is not None and item.name.text in peers:
            named |= set(_values(item, ("provides",)))
    steps = {each.rpartition(".")[2] for each in named}
    known = [each for each in bench.elements(path, jaus.Service) if each.name in steps]
    return {
        str(message.name)
        for service in with_inherited(known)
        for message in (*service.inputs, *service.outputs)
    }


def _values(block: Element, features: Iterable[str]) -> Iterator[str]:
    for item in block.items:
        if isinstance(item, Feature) and item.name.text in features:
            yield from (each.text for each in item.values if isinstance(each, Name))
