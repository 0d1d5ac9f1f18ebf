"""Places in texts: which element is written there.

A page counts units of UTF-16, and one for each end of a line.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, TypeAlias

from jausml.authoring.editing.xmi.source import Source
from jausml.language.text.reading.document import TextDocument

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model import Document, Model

    _LineAndColumn: TypeAlias = tuple[int, int]
    _Spanned: TypeAlias = tuple[_LineAndColumn, _LineAndColumn, EObject]

_LINE_END = re.compile(r"\r\n?|\n")


def element_at(model: Model, offset: int) -> EObject | None:
    """Returns the innermost element that is written at a place, None where there is none.

    Args:
        offset: The place, as a page counts.
    """
    document = model.documents[0]
    if not document.readable:
        return None
    if isinstance(document.written, TextDocument):
        spans = _spans_in_text(document, document.written)
        place = _place(document.data.decode("utf-8-sig", "replace"), offset)
    else:
        source = Source(document, document.display)
        place = _place(source.text, offset)
        spans = _spans_in_xmi(document, source, _characters(source.text, place))
    around = [(start, obj) for start, end, obj in spans if start <= place <= end]
    # Of two that touch, the one that begins last; of two that begin together, the inner one.
    latest = max((start for start, _ in around), default=None)
    return next((obj for start, obj in reversed(around) if start == latest), None)


def _spans_in_text(document: Document, written: TextDocument) -> Iterator[_Spanned]:
    # What follows from something else stands nowhere, and what it owns may stand anywhere.
    waiting = list(reversed(document.root_nodes))
    while waiting:
        node = waiting.pop()
        waiting += reversed(node.children)
        item = written.source_of(node)
        if item is not None and node.obj is not None:
            span = item.span
            yield (span.line, span.column), (span.end_line, span.end_column), node.obj


def _spans_in_xmi(document: Document, source: Source, at: int) -> Iterator[_Spanned]:
    """Yields the elements around a place, which is given in characters."""
    waiting = list(document.root_nodes)
    while waiting:
        node = waiting.pop()
        element = source.element(node)
        if element.start <= at <= element.end:
            waiting += node.children
            if node.obj is not None:
                yield _of(source.text, element.start), _of(source.text, element.end), node.obj


def _place(text: str, offset: int) -> _LineAndColumn:
    """Returns line and column of a place, counted from 1 in characters."""
    flat = _LINE_END.sub("\n", text).encode("utf-16-le", "surrogatepass")
    before = flat[: 2 * offset].decode("utf-16-le", "replace")
    return before.count("\n") + 1, len(before) - before.rfind("\n")


def _of(text: str, at: int) -> _LineAndColumn:
    """Returns line and column of a character."""
    before = _LINE_END.sub("\n", text[:at])
    return before.count("\n") + 1, len(before) - before.rfind("\n")


def _characters(text: str, place: _LineAndColumn) -> int:
    """Returns the character at a line and column."""
    starts = [0, *(each.end() for each in _LINE_END.finditer(text))]
    return starts[place[0] - 1] + place[1] - 1
