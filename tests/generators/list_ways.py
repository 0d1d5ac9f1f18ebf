"""A translation whose lists are gone over as a whole, and element by element, side by side."""

from __future__ import annotations

import importlib
import warnings
from functools import cache
from typing import TYPE_CHECKING, Any

from jausml.generation.native import SOURCE, build, compiler

if TYPE_CHECKING:
    from collections.abc import Callable

    from tests.generators.assignment_support import Generated


def ways(made: Generated, name: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The translation of a connection on bytes, as it runs, and element by element."""
    connection = getattr(made.bridge, name)
    translate = getattr(made.bridge, f"translate_{name}")
    base = vars(importlib.import_module(f"{made.package}.{made.package}_base"))
    kind = translate.__annotations__["source"]
    source = base.get(kind) or getattr(made.messages, kind)

    def whole(data: bytes) -> Any:
        if hasattr(source, "from_cdr"):
            return translate(source.from_cdr(data)).encode()
        return translate(source.decode(data)).to_cdr()

    def one_by_one(data: bytes) -> Any:
        connection.goes_over_lists = False
        try:
            return whole(data)
        finally:
            connection.goes_over_lists = True

    return whole, one_by_one


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


def compiled(made: Generated, name: str) -> Callable[[bytes], bytes | None] | None:
    """The compiled form of the translation of a connection; None where there is none."""
    found = getattr(getattr(made.bridge, f"translate_{name}"), "compiled", None)
    program = compiler()
    if found is None or program is None:
        return None
    (built,) = build([made.folder / made.package / SOURCE], program)
    assert built.reason == ""
    note = getattr(made.bridge, name).drop_field.unknown
    function: Callable[[bytes], bytes | None] = found.of(made.bridge, library(made), note)
    return function


@cache
def library(made: Generated) -> Any:
    """The library of a bridge."""
    return made.bridge.core.load()


def check(made: Generated, name: str, data: bytes) -> Any:
    """All ways make the same, of which the compiled one may give way; returns it."""
    whole, one_by_one = ways(made, name)
    found = outcome(made, name, whole, data)
    assert found == outcome(made, name, one_by_one, data)
    function = compiled(made, name)
    if function is not None:
        assert outcome(made, name, function, data) in (found, (None, {}))
    return found[0]
