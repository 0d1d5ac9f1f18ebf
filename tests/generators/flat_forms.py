"""The flat and the readable form of a translation, side by side."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from tests.generators.assignment_support import Generated


def forms(made: Generated, name: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The flat and the readable translation of a connection, both on bytes."""
    method = getattr(type(made.bridge), f"translate_{name}")
    flat = method.transcoder(made.bridge, getattr(made.bridge, name))
    readable = getattr(made.bridge, f"translate_{name}")
    base = vars(__import__(f"{made.package}.{made.package}_base", fromlist=["*"]))
    kind = method.__annotations__["source"]
    source = base.get(kind) or getattr(made.messages, kind)
    if name.endswith("up"):
        return flat, lambda data: readable(source.decode(data)).to_cdr()
    return flat, lambda data: readable(source.from_cdr(data)).encode()


def outcome(made: Generated, name: str, translate: Callable[..., Any], data: bytes) -> Any:
    """What becomes of bytes: the result or the error, and what the limits counted."""
    counts = getattr(made.bridge, name).statistics.out_of_range
    counts.clear()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            result = translate(data)
    except made.error("JausError") as error:
        result = type(error), str(error)
    return result, dict(counts)


def check(made: Generated, name: str, data: bytes) -> Any:
    """Both forms make the same; returns it."""
    flat, readable = forms(made, name)
    found = outcome(made, name, flat, data)
    assert found == outcome(made, name, readable, data)
    return found[0]
