"""Writer of models as ros2jaus text: the syntax tree of a model, laid out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from jausml.language.model.names import name_of
from jausml.language.model.xmi.writer import UnwritableError, is_written
from jausml.language.semantics.memory import remembering
from jausml.language.text.root_names import system_name
from jausml.language.text.tree import (
    DEEPEST,
    LONGEST,
    BlockItem,
    Element,
    Import,
    Item,
    SyntaxTree,
    lists_of,
)
from jausml.language.text.writing import layout
from jausml.language.text.writing.elements import ElementWriter
from jausml.language.text.writing.layout import space_document
from jausml.language.text.writing.maps import MAP, MapWriter
from jausml.language.text.writing.references import ReferenceNames

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Sequence

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model

IMPLIED_PARTS = {
    "system.System": ("components", "nodes", "bridges", "hosts", "placements"),
    "bridge.MapLibrary": ("maps",),
}
"""Root elements that need not be written when the file gives them their name, with the parts that
may then stand by themselves."""


def to_text(roots: Sequence[EObject], model: Model, path: str | os.PathLike[str]) -> str:
    """Returns root elements with all that they own as ros2jaus text in its canonical layout.

    Args:
        path: The file that the text is meant for. Imports are relative to it, and a system or map
            library of its name is left to be implied.

    Raises:
        UnwritableError: A reference leads to an element that neither the roots nor a document of
            the model own, or the text would be longer or deeper than texts may be.
    """
    with remembering():
        document = to_tree(roots, model, path)
    if _depth(document.items) > DEEPEST:
        raise UnwritableError(f"its elements are nested more than {DEEPEST} deep")
    text = layout.lay_out(document)
    if len(text) > LONGEST:
        raise UnwritableError(f"the text would have more than {LONGEST:,} characters")
    return text


def to_tree(roots: Sequence[EObject], model: Model, path: str | os.PathLike[str]) -> SyntaxTree:
    """Returns root elements with all that they own as a syntax tree."""
    names = ReferenceNames(roots, model, Path(path))
    elements = ElementWriter(model.metamodels, names)
    elements.special[MAP] = MapWriter(elements, names, model.metamodels).items
    document = SyntaxTree()
    document.items += [Import(target) for target in names.imports]
    implied: set[str] = set()
    for root in roots:
        qualified_class = model.metamodels.class_of(root).qualified_name
        parts = [] if qualified_class in implied else _parts(root, elements, model, Path(path))
        if parts:
            implied.add(qualified_class)
        document.items += parts or [elements.root(root)]
    space_document(document.items)
    return document


def _parts(root: EObject, elements: ElementWriter, model: Model, path: Path) -> list[BlockItem]:
    """Returns what stands in a root that follows from the file and its contents; else nothing."""
    table = model.metamodels.class_of(root)
    names = IMPLIED_PARTS.get(table.qualified_name)
    if names is None or name_of(root) != system_name(path):
        return []
    others = (each for name, each in table.features.items() if name not in ("name", *names))
    if any(is_written(root, each) for each in others):
        return []
    parts = elements.children(root, names)
    return parts if all(isinstance(each, Element) for each in parts) else []


def _depth(items: Iterable[Item]) -> int:
    """Returns how deep the brackets of items are nested, of arrows as if all had some."""
    inner = (_depth(each) for item in items for each, _ in lists_of(item))
    return max((1 + each for each in inner), default=0)
