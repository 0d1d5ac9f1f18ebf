"""What scaled fields of messages hold, and whether a message came back as near as they allow."""

import sys
from collections.abc import Iterator
from typing import Any

from jausml_generators.python.codec.classes import ContainerClass, VariableFieldClass
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.codec.scalars import Bits, Fixed


def differences(view: MessageView, sent: Any, received: Any) -> list[str]:
    """Returns where two messages differ by more than their encoding explains.

    Args:
        view: The message.
        sent: The message that was encoded.
        received: The message that was decoded.
    """
    return _container(view.body, sent, received, view.class_name)


def coded_values(view: MessageView, message: Any) -> list[tuple[Fixed, Any]]:
    """Returns the scaled and bit fields of a message with their values, in wire order."""
    return list(_coded_in(view.body, message))


def _coded_in(part: Any, message: Any) -> Iterator[tuple[Fixed, Any]]:
    if isinstance(part, VariableFieldClass):
        chosen = next(
            alternative for alternative in part.alternatives if alternative.index == message.index
        )
        yield from _coded_of(chosen.value, message.value)
        return
    for member in part.members:
        value = getattr(message, member.attribute)
        if value is not None:
            yield from _coded_of(member.value, value)


def _coded_of(value: Any, content: Any) -> Iterator[tuple[Fixed, Any]]:
    if value.kind in ("list", "array"):
        for item in content:
            yield from _coded_of(value.element, item)
    elif value.kind == "variant":
        yield from _coded_in(value.options[content.TAG].part, content)
    elif value.kind == "part":
        yield from _coded_in(value.part, content)
    elif isinstance(value, Bits) or (isinstance(value, Fixed) and value.scale is not None):
        yield value, content


def _container(part: ContainerClass, sent: Any, received: Any, place: str) -> list[str]:
    found = []
    for member in part.members:
        pair = (getattr(sent, member.attribute), getattr(received, member.attribute))
        found += _value(member.value, *pair, f"{place}.{member.attribute}")
    return found


def _value(value: Any, sent: Any, received: Any, place: str) -> list[str]:
    if type(sent) is not type(received):
        # A float field may hold an integer; a missing field may hold nothing.
        if sent is None or received is None or value.python_type != "float":
            return [f"{place}: {sent!r} became {received!r}"]
    elif sent is None:
        return []
    if value.kind in ("list", "array"):
        if len(sent) != len(received):
            return [f"{place}: {len(sent)} became {len(received)}"]
        pairs = enumerate(zip(sent, received, strict=True))
        return [d for i, pair in pairs for d in _value(value.element, *pair, f"{place}[{i}]")]
    if value.kind == "variant":
        return _container(value.options[sent.TAG].part, sent, received, place)
    if value.kind == "part":
        return _part(value.part, sent, received, place)
    if isinstance(value, Fixed) and value.scale is not None:
        return _scaled(value, sent, received, place)
    return [] if sent == received else [f"{place}: {sent!r} became {received!r}"]


def _part(part: Any, sent: Any, received: Any, place: str) -> list[str]:
    if not isinstance(part, VariableFieldClass):
        return _container(part, sent, received, place)
    if sent.index != received.index:
        return [f"{place}: index {sent.index} became {received.index}"]
    chosen = next(
        alternative for alternative in part.alternatives if alternative.index == sent.index
    )
    return _value(chosen.value, sent.value, received.value, place)


def _scaled(value: Fixed, sent: float, received: float, place: str) -> list[str]:
    """Half a step when rounding to the nearest, a step when rounding one way."""
    assert value.scale is not None
    lower, upper = value.scale
    step = (upper - lower) / (2 ** (8 * value.size) - 1)
    allowed = step / 2 if value.check == "scaled" else step
    allowed += 1e-3 * step + 4 * sys.float_info.epsilon * (abs(lower) + abs(upper))
    if abs(sent - received) <= allowed:
        return []
    return [f"{place}: {sent!r} became {received!r}, more than {allowed!r} away"]
