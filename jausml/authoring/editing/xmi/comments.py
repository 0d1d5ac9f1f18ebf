"""Comments of an XMI file, by the elements that they belong to."""

from __future__ import annotations

from collections import defaultdict
from xml.parsers import expat


class Comments:
    """The comments and processing instructions of a document, each with its marks.

    Elements are named by the offsets of their start tags in bytes.

    Attributes:
        before: Those before an element, behind what stands before it.
        trailing: Those behind an element on its last line.
        closing: Those behind all that an element has.
        last: Those behind the root, on lines of their own.
    """

    def __init__(self, data: bytes) -> None:
        self.before: dict[int, list[str]] = {}
        self.trailing: defaultdict[int, list[str]] = defaultdict(list)
        self.closing: dict[int, list[str]] = {}
        self.last: list[str] = []
        # Most files need no second parse. Without its zeros, UTF-16 reads like ASCII.
        if b"<!--" in (plain := data.replace(b"\0", b"")) or plain.count(b"<?") > 1:
            self._find(data)

    def _find(self, data: bytes) -> None:
        parser = expat.ParserCreate()
        waiting = self.last
        around: list[int] = []
        ended: int | None = None

        def note(text: str) -> None:
            at = parser.CurrentByteIndex
            line = data[data.rfind(b"\n", 0, at) + 1 : at].replace(b"\0", b"")
            # On the line where an element ended it speaks of that; a lone \r ends a line too.
            is_behind = ended is not None and line.strip() and b"\r" not in line.strip()
            (self.trailing[ended] if ended is not None and is_behind else waiting).append(text)

        def start(_name: str, _attributes: object) -> None:
            nonlocal ended
            ended = None
            around.append(parser.CurrentByteIndex)
            self.before[around[-1]] = waiting[:]
            waiting.clear()

        def end(_name: str) -> None:
            nonlocal ended
            ended = around.pop()
            self.closing[ended] = waiting[:]
            waiting.clear()

        parser.CommentHandler = lambda text: note(f"<!--{text}-->")
        parser.ProcessingInstructionHandler = lambda name, text: note(f"<?{name} {text}?>")
        parser.StartElementHandler = start
        parser.EndElementHandler = end
        parser.Parse(data, True)  # noqa: FBT003 -- expat has no keywords
