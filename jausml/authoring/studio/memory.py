"""Where boxes and lines of views stood, kept from one session to the next beside the models.

The folder says to Git that it is no part of the project: what users place by hand is in the layout
file, which is.
"""

from __future__ import annotations

import json
import logging
import threading
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.reading import Disk
from jausml.views.diagrams.layout.sheet import Route
from jausml.views.diagrams.writers.values import Standing

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from jausml.views.diagrams.layout.sheet import Point

_LOG = logging.getLogger(__name__)

FOLDER = ".jausml"
_IGNORE, _ALL = ".gitignore", b"*\n"
_LARGEST = 16 * 1024 * 1024
_FARTHEST = 1_000_000


class Memory:
    """What is remembered of the views of all files; any thread may ask."""

    def __init__(self, root: Path) -> None:
        self._disk = Disk(root)
        self._lock = threading.Lock()
        self._views: dict[str, dict[str, Any]] = {}

    def standing(self, file: str, view: str) -> Standing:
        """Returns where the parts of a view stood; nothing where that is not known."""
        with self._lock:
            if file not in self._views:
                self._views[file] = self._read(file)
            known = self._views[file].get(view)
        try:
            return _standing(known)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            return Standing()

    def keep(self, file: str, standings: Mapping[str, Standing]) -> None:
        """Keeps where the parts of views of a file stand; those of other views stay as they are."""
        with self._lock:
            before = self._views.get(file, {})
            now = before | {view: _values(standing) for view, standing in standings.items()}
            if now == before:
                return
            self._views[file] = now
            text = json.dumps({"views": now}, ensure_ascii=False, separators=(",", ":"))
            try:
                self._store(_place(file, _IGNORE), _ALL)
                self._store(_place(file), text.encode("utf-8", "backslashreplace"))
            except (EditError, OSError):
                _LOG.debug("places of %s are not kept", file, exc_info=True)

    def _store(self, path: str, data: bytes) -> None:
        # It is looked at first: it may lead out of the folder.
        if self._disk.read(path) != data:
            self._disk.store(path, data)

    def _read(self, file: str) -> dict[str, Any]:
        data = self._disk.readable(_place(file)) or b""
        try:
            views = json.loads(data)["views"] if len(data) <= _LARGEST else {}
        except (LookupError, RecursionError, TypeError, ValueError):
            return {}
        return views if isinstance(views, dict) else {}


def _place(file: str, name: str = "") -> str:
    path = PurePosixPath(file)
    return str(path.parent / FOLDER / (name or f"{path.name}.views.json"))


def _values(standing: Standing) -> dict[str, Any]:
    return {
        "framed": standing.is_crowded,
        "large": standing.is_large,
        "boxes": {key: list(corner) for key, corner in standing.boxes.items()},
        "shown": [[key, kind, *corner] for key, (kind, corner) in standing.shown.items()],
        "rows": {key: [list(order) for order in rows] for key, rows in standing.rows.items()},
        "routes": [
            [list(way), [list(point) for point in route.points], route.label and list(route.label)]
            for way, route in standing.routes.items()
        ],
    }


def _standing(known: dict[str, Any] | None) -> Standing:
    if known is None:
        return Standing()
    return Standing(
        boxes={key: _point(corner) for key, corner in known["boxes"].items()},
        shown={key: (str(kind), _point(corner)) for key, kind, *corner in known["shown"]},
        rows={
            key: (list(map(str, model)), list(map(str, shown)))
            for key, (model, shown) in known["rows"].items()
        },
        routes={
            tuple(map(_number, way)): Route(
                tuple(map(_point, points)), None if label is None else _point(label)
            )
            for way, points, label in known["routes"]
        },
        is_crowded=known["framed"] is True,
        is_large=known["large"] is True,
    )


def _point(values: list[float]) -> Point:
    x, y = map(_number, values)
    return x, y


def _number(value: float) -> float:
    if not abs(value) <= _FARTHEST:
        raise ValueError(f"{value} is no place")
    return value
