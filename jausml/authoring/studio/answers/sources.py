"""Sources: where the text of an element stands in its file."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.authoring.editing.xmi.source import Source
from jausml.language.model import refs
from jausml.language.text.reading.document import TextDocument

if TYPE_CHECKING:
    from jausml.authoring.proposals.elements import Scope
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model import Document, Model
    from jausml.language.model.xmi.parsing import Node
    from jausml.language.text.tree import Span

XMI, TEXT = "xmi", "text"
_LINE_END = re.compile(r"\r\n?|\n")


@dataclass(frozen=True, slots=True)
class Located:
    """The text of a file, and where in it an element stands.

    Attributes:
        notation: `xmi` or `text`.
        start: Where the element begins, in units of UTF-16 as browsers count them.
        line: Its first line, counted from 1.
    """

    file: str
    notation: str
    text: str
    start: int
    end: int
    line: int


def source(scope: Scope, ref: str) -> Located:
    """Returns where an element stands; where its owner does if the text has not written it."""
    element = scope.find(ref)
    file, _ = refs.split(ref)
    model = scope.model_of(element)
    document = model.document_of(element)
    if document is None:
        return Located(file, XMI, "", 0, 0, 1)
    if isinstance(document.written, TextDocument):
        return _in_text(document, document.written, model, element, file)
    return _in_xmi(document, model, element, file)


def _in_xmi(document: Document, model: Model, element: EObject, file: str) -> Located:
    whole = Source(document, file)
    node = _written(model, element)
    start = end = 0
    if node is not None:
        found = whole.element(node)
        start, end = found.start, found.end
    return _located(file, XMI, whole.text, start, end)


def _in_text(
    document: Document, written: TextDocument, model: Model, element: EObject, file: str
) -> Located:
    text = document.data.decode("utf-8-sig", "replace")
    span = _span(written, model, element)
    start, end = (0, 0) if span is None else _offsets(text, span)
    return _located(file, TEXT, text, start, end)


def _span(written: TextDocument, model: Model, element: EObject) -> Span | None:
    """Returns what is written of an element, or of the nearest of its owners."""
    around: EObject | None = element
    while around is not None:
        node = model.node_of(around)
        found = written.source_of(node) if node is not None else None
        if found is not None:
            return found.span
        around = around.eContainer()
    return None


def _written(model: Model, element: EObject) -> Node | None:
    around: EObject | None = element
    while around is not None:
        node = model.node_of(around)
        if node is not None:
            return node
        around = around.eContainer()
    return None


def _offsets(text: str, span: Span) -> tuple[int, int]:
    starts = [0, *(match.end() for match in _LINE_END.finditer(text))]
    return (
        starts[span.line - 1] + span.column - 1,
        starts[span.end_line - 1] + span.end_column - 1,
    )


def _located(file: str, notation: str, text: str, start: int, end: int) -> Located:
    line = len(_LINE_END.findall(text[:start])) + 1
    return Located(
        file, notation, _LINE_END.sub("\n", text), _units(text[:start]), _units(text[:end]), line
    )


def _units(text: str) -> int:
    """Returns the units of UTF-16 of a text, in which an end of a line is one."""
    flat = _LINE_END.sub("\n", text)
    return len(flat.encode("utf-16-le", "surrogatepass")) // 2
