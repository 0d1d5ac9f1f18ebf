"""Lists of items in a text: new ones go in, others go out, the rest stays as it is laid out."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from jausml.language.text.tree import Direction, Entry, Feature, Member, Table, Vector, VectorEntry
from jausml.language.text.writing.layout import WIDTH, lines_of, space

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.text.source import Body, Edits, Outline
    from jausml.language.text.tree import Item

_INDENT = "    "
_SPACE = "  "
_SHORT = (Feature, Member, Entry, VectorEntry)
_DENSE = (Direction, Table, Vector)
"""Lists whose items follow each other without empty lines."""


class Blocks:
    """Changes of the lists of a text."""

    def __init__(self, outline: Outline, edits: Edits) -> None:
        self._outline = outline
        self._edits = edits
        self._source = edits.source

    # What goes in

    def insert(self, body: Body, before: Item | None, item: Item) -> None:
        """Puts a new item into a list.

        `before`: the item behind which it goes, None for the first place.
        """
        indent = self.indent(body)
        self.insert_raw(body, before, item, self.lines(item, indent))

    def lines(self, item: Item, indent: str) -> list[str]:
        """Returns the lines of an item, indented as the text does it."""
        lines = lines_of(item, WIDTH - len(indent.expandtabs(len(_INDENT))))
        if self._source.unit != _INDENT:
            lines = [_with_unit(each, self._source.unit) for each in lines]
        return [f"{indent}{each}" if each else each for each in lines]

    def insert_lines(
        self, body: Body, before: Item | None, lines: Sequence[str], *, is_spaced: bool
    ) -> None:
        """Puts lines into a list that has lines of its own.

        `is_spaced`: whether an empty line parts them from what is before.
        """
        block = "\n".join(lines)
        index = self._outline.place(before)[1] + 1 if before is not None else 0
        following = body.items[index] if index < len(body.items) else None
        if before is not None:
            lead = "\n\n" if is_spaced else "\n"
            self._insert_behind(body, before, following, lead, block)
        elif following is not None:
            self._insert_first(body, following, block, is_spaced=is_spaced)
        else:
            self._fill(body, block)

    def insert_raw(self, body: Body, before: Item | None, item: Item, lines: Sequence[str]) -> None:
        """Puts an item of the text into a list once more, as it is written."""
        if self._is_inline(body):
            self._insert_inline(body, before, item, lines)
        else:
            self.insert_lines(body, before, lines, is_spaced=self._is_spaced(body, before, item))

    def breaks(self, body: Body, item: Item, lines: Sequence[str]) -> bool:
        """Tells whether a list on one line has no room for one more, and gets lines."""
        if not self._is_inline(body):
            return False
        source, line = self._source, lines[0].strip()
        end = source.line_end(body.end)
        width = end - source.line_start(body.start) + len(_SPACE) + len(line)
        is_short = len(lines) == 1 and isinstance(item, _SHORT) and width <= WIDTH
        return not is_short or (not source.is_blank(body.start, body.end) and not body.items)

    def append_block(self, end: int, item: Item, *, indent: str) -> None:
        """Gives an item that has no block one with a new item in it."""
        lines = self.lines(item, indent + self._source.unit)
        line = lines[0].strip()
        width = end - self._source.line_start(end) + len(line) + len(" {  }")
        if len(lines) == 1 and isinstance(item, _SHORT) and width <= WIDTH:
            self._edits.insert(end, f" {{ {line} }}")
        else:
            self._edits.insert(end, "\n".join([" {", *lines, f"{indent}}}"]))

    def indent(self, body: Body) -> str:
        """Returns what the items of a list are indented by."""
        for item in body.items:
            start = self._outline.start(item)
            if self._source.begins_line(start):
                return self._source.indent_of(start)
        if body.owner is None:
            return ""
        return self._source.indent_of(self._outline.start(body.owner)) + self._source.unit

    def _is_inline(self, body: Body) -> bool:
        if body.owner is None:
            return False
        return "\n" not in self._source.text[body.start : body.end]

    def _insert_inline(
        self, body: Body, before: Item | None, item: Item, lines: Sequence[str]
    ) -> None:
        """Puts an item into a list that stands on one line, if it fits there."""
        line = lines[0].strip()
        if self.breaks(body, item, lines):
            self._break(body, before, item, lines)
        elif not body.items:
            self._edits.replace(body.start, body.end, f" {line} ")
        elif before is not None:
            self._edits.insert(self._outline.whole_end(before), f"{_SPACE}{line}")
        else:
            start = self._outline.whole_start(body.items[0])
            self._edits.insert(start, f"{line}{_SPACE}")

    def _break(self, body: Body, before: Item | None, item: Item, lines: Sequence[str]) -> None:
        """Gives each item of a list on one line a line of its own, and new lines their place.

        An item of the list itself is moved: it stands nowhere else then.
        """
        source = self._source
        indent = self.indent(body)
        cuts = [body.start, *map(self._outline.whole_start, body.items[1:]), body.end]
        parts = [source.text[a:b].strip() for a, b in pairwise(cuts)]
        stacked: list[str] = [] if before is not None else [*lines]
        for at, part in enumerate(parts):
            own = body.items[at] if at < len(body.items) else None
            if part and own is not item:
                stacked.append(f"{indent}{part}")
            if own is not None and own is before:
                stacked += lines
        owner = body.owner
        around = source.indent_of(self._outline.start(owner)) if owner is not None else ""
        self._edits.replace(body.start, body.end, "\n".join(["", *stacked, around]))

    def _insert_behind(
        self, body: Body, before: Item, following: Item | None, lead: str, block: str
    ) -> None:
        source = self._source
        end = self._outline.end(before)
        line_end = source.line_end(end)
        if following is not None and self._outline.start(following) < line_end:
            whole = self._outline.whole_end(before)
            start = self._outline.whole_start(following)
            if source.is_blank(whole, start):
                self._edits.replace(whole, start, f"{lead}{block}\n{self.indent(body)}")
            else:
                self._edits.insert(whole, f"{lead}{block}\n{self.indent(body)}")
            return
        is_closing = body.owner is not None and body.end <= line_end
        comments = source.comments_within(end, line_end)
        if is_closing or not all(each.is_on_one_line for each in comments):
            self._edits.insert(self._outline.whole_end(before), f"{lead}{block}")
        else:
            self._edits.insert(line_end, f"{lead}{block}")

    def _insert_first(self, body: Body, following: Item, block: str, *, is_spaced: bool) -> None:
        source = self._source
        behind = "\n\n" if is_spaced else "\n"
        if body.owner is None:
            start = self._outline.whole_start(following)
            self._edits.insert(source.line_start(start), f"{block}{behind}")
            return
        line_end = source.line_end(body.start)
        if source.is_blank(body.start, line_end) and line_end < body.end:
            extra = "\n" if is_spaced and not following.spaced else ""
            self._edits.insert(line_end, f"\n{block}{extra}")
        else:
            start = source.behind_blanks(body.start)
            self._edits.replace(body.start, start, f"\n{block}\n{self.indent(body)}")

    def _fill(self, body: Body, block: str) -> None:
        """Puts lines into a list without items."""
        source = self._source
        inner = source.text[body.start : body.end]
        if body.owner is None:
            end = body.start + len(inner.rstrip())
            last = "\n" if not inner.strip() and inner.endswith("\n") else ""
            lead = "\n\n" if end else ""
            self._edits.replace(end, end + len(last), f"{lead}{block}{last}")
        elif inner.strip():
            self._edits.insert(body.start + len(inner.rstrip()), f"\n{block}")
        else:
            around = source.indent_of(self._outline.start(body.owner))
            self._edits.replace(body.start, body.end, f"\n{block}\n{around}")

    def _is_spaced(self, body: Body, before: Item | None, item: Item) -> bool:
        """Tells whether an empty line parts a new item from its neighbour."""
        if body.owner is None:
            return True
        if isinstance(body.owner, _DENSE):
            return False
        if before is None:
            following = body.items[0] if body.items else None
            return following is not None and _space_between(item, following)
        index = self._outline.place(before)[1]
        if index and type(before) is type(item):
            return before.spaced
        return _space_between(before, item)

    # What goes out

    def remove(self, body: Body, items: Sequence[Item]) -> None:
        """Takes items out of a list, with the comments that are their own."""
        if self._is_inline(body) and len(items) == len(body.items):
            self._edits.delete(body.start, body.end)
            return
        for item in items:
            self._remove(body, item)

    def _remove(self, body: Body, item: Item) -> None:
        source = self._source
        start, end = self._outline.whole_start(item), self._outline.whole_end(item)
        line_end = source.line_end(end)
        if source.begins_line(start) and source.is_blank(end, line_end):
            self._edits.delete(*self._lines(body, source.line_start(start), line_end))
            return
        index = self._outline.place(item)[1]
        following = body.items[index + 1] if index + 1 < len(body.items) else None
        if not source.begins_line(start) and index:
            self._edits.delete(source.before_space(start, body.start), end)
        elif following is not None and self._outline.whole_start(following) < line_end:
            self._edits.delete(start, self._outline.whole_start(following))
        else:
            self._edits.delete(start, end)

    def _lines(self, body: Body, start: int, line_end: int) -> tuple[int, int]:
        """Returns the stretch of whole lines that go, with an empty one that parted them."""
        source = self._source
        end = source.next_line(line_end)
        above = source.line_start(start - 1) if start > body.start and start else start
        is_parted = above < start and source.is_blank(above, start) and above >= body.start
        below = source.line_end(end)
        is_last = body.end <= source.line_end(end) and source.is_blank(end, body.end)
        is_first = source.is_blank(body.start, start)
        if is_parted and (is_last or source.is_blank(end, below)):
            start = above
        elif is_first and end < len(source.text) and source.is_blank(end, below):
            end = source.next_line(below)
        if line_end == len(source.text) and start:
            # The text keeps lacking a line end.
            start = source.line_end(source.line_start(start - 1))
        return start, end


def _space_between(before: Item, item: Item) -> bool:
    kept = item.spaced
    space([before, item])
    found, item.spaced = item.spaced, kept
    return found


def _with_unit(line: str, unit: str) -> str:
    depth = (len(line) - len(line.lstrip(" "))) // len(_INDENT)
    return unit * depth + line[depth * len(_INDENT) :]
