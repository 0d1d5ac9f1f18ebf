"""Reports that pages watch: last values, pictures, and the history of each number."""

from __future__ import annotations

import base64
import math
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from operator import itemgetter
from threading import Lock
from typing import Any

from jausml.language import wire
from jausml.live.messages import MessageEntry
from jausml.live.peers.operator import Operator
from jausml.live.peers.query_client import Refused
from jausml.live.peers.rendering import Leaf, field_texts, leaves
from jausml.runtime import EventSubscription
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.standstill import steady

MOST_WATCHED = 32
MOST_FIELDS = 64  # numbers of one report that have a history

MOST_KEPT = 20_000  # values in the history of a number: more than 10 minutes at 30 Hz

LONGEST_TEXT = 80  # characters of a shown value

RATE = ""  # path, in the history, of the rate in Hz at which a report comes

# Limits of a picture that a browser unpacks without harm.
MOST_BYTES = 8 * 2**20
MOST_PIXELS = 40_000_000
_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8\xff"
_HEADERS = 2**18  # bytes at the beginning of a JPEG that must have its size
_FRAMES = {*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC}  # JPEG markers with the size (ITU-T T.81, B.1)

Point = tuple[float, float]  # a time in seconds, and a value


@dataclass
class Watched:
    """A report of a component that is watched.

    Attributes:
        last_heard: Seconds of a clock that nobody sets, as in its history; 0 before any report.
        texts: Paths and values of fields in words.
        pictures: Hexadecimal bytes by their paths.
        urls: Addresses of streams and files (IOP, Digital Resource Discovery).
    """

    component: str
    report: str
    subscription: EventSubscription | None = None
    pages: set[int] = field(default_factory=set)
    last_heard: float = 0.0
    count: int = 0
    texts: list[tuple[str, str]] = field(default_factory=list)
    pictures: dict[str, str] = field(default_factory=dict)
    urls: tuple[str, ...] = ()
    history: dict[str, deque[Point]] = field(default_factory=dict)


class Values:
    """The reports that pages watch; any thread may call it."""

    def __init__(self) -> None:
        """Begins with no report."""
        self._watched: dict[tuple[str, str], Watched] = {}
        self._lock = Lock()

    def watch(
        self,
        operator: Operator,
        target: JausAddress,
        name: str,
        rate: float | None,
        page: int,
        fields: dict[str, Any] | None = None,
    ) -> None:
        """Subscribes to a report for a page; pages share one subscription.

        Args:
            name: Name of the report.
            rate: Reports each second; None for an event of changes.
            fields: Fields of the query; None asks for all fields of the report.
        """
        _, report = operator.exchange(target, name)
        key = str(target), report.name
        with self._lock:
            if key not in self._watched and len(self._watched) >= MOST_WATCHED:
                raise Refused(f"{MOST_WATCHED} reports are watched; watch one of them no more")
            known = self._watched.setdefault(key, Watched(*key))
            is_first = not known.pages
            known.pages.add(page)
        if is_first:
            try:
                subscription = operator.watch(
                    target,
                    report.name,
                    rate,
                    lambda *arguments: self._take(key, *arguments),
                    fields,
                )
            except BaseException:
                with self._lock:
                    self._watched.pop(key, None)
                raise
            known.subscription = subscription
            if not known.pages:  # the page left meanwhile
                subscription.cancel()

    def unwatch(self, component: str, report: str, page: int) -> None:
        """Ends the watch of a report by a page; that of the last page ends the subscription."""
        with self._lock:
            known = self._watched.get((component, report))
            if known is None:
                return
            known.pages.discard(page)
            if known.pages:
                return
            del self._watched[component, report]
        if known.subscription is not None:
            known.subscription.cancel()

    def leave(self, page: int) -> None:
        """Ends all that a page watches."""
        with self._lock:
            keys = [key for key, watch in self._watched.items() if page in watch.pages]
        for component, report in keys:
            self.unwatch(component, report, page)

    def last(self) -> list[dict[str, Any]]:
        """Returns the last values of each report, as JSON values."""
        now = steady()
        with self._lock:
            return [
                {
                    "component": watch.component,
                    "report": watch.report,
                    "age": round(now - watch.last_heard, 2) if watch.last_heard else None,
                    "count": watch.count,
                    "fields": [list(pair) for pair in watch.texts],
                    "numbers": [path for path in watch.history if path != RATE],
                    "pictures": list(watch.pictures),
                    "urls": watch.urls,
                }
                for watch in self._watched.values()
            ]

    def picture(self, component: str, report: str, path: str) -> str:
        """Returns the URL of the last picture of a report (`Refused`: there is none)."""
        with self._lock:
            known = self._watched.get((component, report))
            picture_hex = known.pictures.get(path, "") if known is not None else ""
        return picture_url(bytes.fromhex(picture_hex))

    def history(
        self, component: str, report: str, path: str, seconds: float, most: int
    ) -> list[Point]:
        """Returns the values of a number in the last `seconds`, decimated to `most` points.

        Their times are those of `standstill.steady`: values of one report have the same.
        """
        begin = steady() - seconds
        with self._lock:
            known = self._watched.get((component, report))
            kept = known.history.get(path, ()) if known is not None else ()
            points = [point for point in kept if point[0] >= begin]
        return decimated(points, most)

    def _take(self, key: tuple[str, str], entry: MessageEntry, fields: dict[str, Any]) -> None:
        now = steady()
        texts = [(path, _short(text)) for path, text in field_texts(entry.record, fields)]
        values = list(leaves(entry.record, fields))
        numbers_by_path = dict(_numbers(values))
        with self._lock:
            known = self._watched.get(key)
            if known is None:
                return
            if known.last_heard and now > known.last_heard:
                numbers_by_path[RATE] = 1 / (now - known.last_heard)
            known.last_heard, known.texts, known.pictures = now, texts, dict(_pictures(values))
            known.urls = tuple(_urls(values))
            known.count += 1
            for path, value in numbers_by_path.items():
                if path in known.history or len(known.history) < MOST_FIELDS:
                    kept = known.history.setdefault(path, deque(maxlen=MOST_KEPT))
                    kept.append((now, value))


def _numbers(values: Iterable[Leaf]) -> Iterator[tuple[str, float]]:
    for path, kind, value in values:
        match kind:
            case wire.VariableNumber():
                yield path, float(value["value"])
            case wire.Integer() | wire.Scaled() | wire.Real():
                yield path, float(int(value) if isinstance(kind, wire.Integer) else value)


def _pictures(values: Iterable[Leaf]) -> Iterator[tuple[str, str]]:
    """Yields paths and hexadecimal values of bytes with a format, which may be pictures."""
    for path, kind, value in values:
        if isinstance(kind, wire.FormattedOctets) and value.get("hex"):
            yield path, value["hex"]


def _urls(values: Iterable[Leaf]) -> Iterator[str]:
    for path, kind, value in values:
        if isinstance(kind, wire.Text) and path.rpartition(".")[2] == "ServerURL":
            yield str(value)


def _short(text: str) -> str:
    return text if len(text) <= LONGEST_TEXT else f"{text[:LONGEST_TEXT]}…"


def decimated(points: Sequence[Point], most: int) -> list[Point]:
    """Returns at most `most` points: the least and the greatest value of each piece, and the last.

    A piece with values that are no finite numbers has one of these, which is a gap in a line.

    Args:
        most: 1 or more.
    """
    if len(points) <= most:
        return list(points)
    *before, last = points
    pieces = (most - 1) // 2
    extremes: list[Point] = []
    for index in range(pieces):
        piece = before[index * len(before) // pieces : (index + 1) * len(before) // pieces]
        extremes.extend(_extremes(piece))
    return [*extremes, last]


def _extremes(piece: Sequence[Point]) -> list[Point]:
    """Returns the points of the least and the greatest value, or one that is no finite number."""
    gap = next((point for point in piece if not math.isfinite(point[1])), None)
    if gap is not None:
        return [gap]
    return sorted({min(piece, key=itemgetter(1)), max(piece, key=itemgetter(1))})


def picture_url(data: bytes) -> str:
    """Returns a data URL with a picture.

    Raises:
        Refused: It is neither JPEG nor PNG, or too large.
    """
    kind = "png" if data.startswith(_PNG) else "jpeg" if data.startswith(_JPEG) else ""
    if not kind:
        raise Refused(f"it begins with {data[:4].hex(' ')}: neither JPEG nor PNG")
    if len(data) > MOST_BYTES:
        raise Refused(f"it has {len(data)} bytes, more than {MOST_BYTES}")
    width, height = _size_of_png(data) if kind == "png" else _size_of_jpeg(data)
    if not 0 < width * height <= MOST_PIXELS:
        raise Refused(f"it has {width} x {height} pixels, not 1 to {MOST_PIXELS}")
    return f"data:image/{kind};base64,{base64.b64encode(data).decode('ascii')}"


def _size_of_png(data: bytes) -> tuple[int, int]:
    if data[12:16] != b"IHDR" or len(data) < 24:
        raise Refused("it is a PNG without a header")
    return int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")


def _size_of_jpeg(data: bytes) -> tuple[int, int]:
    at = 2
    while at + 9 <= min(len(data), _HEADERS) and data[at] == 0xFF:
        marker = data[at + 1]
        if marker in _FRAMES:
            return (
                int.from_bytes(data[at + 7 : at + 9], "big"),
                int.from_bytes(data[at + 5 : at + 7], "big"),
            )
        filling = marker == 0xFF
        at += 1 if filling else 2 + max(2, int.from_bytes(data[at + 2 : at + 4], "big"))
    raise Refused("it is a JPEG without a header")
