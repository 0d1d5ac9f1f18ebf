"""Comparison of the ways of a translation, for the generated tests of a bridge."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from functools import partial
from typing import Any, TypeAlias

from ..base.api import JausError
from ..wire.message import EncodeError
from .bridge import Bridge
from .connections.connection import AnyConnection
from .connections.translations import uses_ros_classes
from .light_message import LightMessage
from .messages.compiled import NoCoreError, compiled_of
from .messages.limits import RosTypeError

CODE_SIZE = 2  # bytes of the message code, by which a payload comes to the right translation

_VALUES = (0x00, 0x01, 0x7F, 0x80, 0xFF)
"""What is put into each byte: it makes small and great numbers, other lengths, other presences."""

_MOST_VARIANTS = 1000
"""Variants that are tried of one message; larger ones are changed at fewer places."""


def differing_forms(
    bridge: Bridge,
    translate: Callable[..., Any],
    connection: AnyConnection,
    source: Any,
    **joins: Any,
) -> list[str]:
    """Returns what the ways of a translation do not make alike of a message and its variants.

    The compiled form, where it is built and does not give way, is compared with Python: what they
    make, the error that they raise, and what they count as out of range. Variants lack an optional
    field, or have another value in one byte. The light class of the ROS message is compared with
    that of rclpy, where that is installed. The clock stands still meanwhile.

    Args:
        **joins: Messages of joined topics, or None.

    Returns:
        Sentences, of the compiled form at most one; nothing when all make the same, when there is
        no such source message, or when an override works on the classes of ROS.
    """
    if uses_ros_classes(translate):
        return []
    try:
        data = _encoded(source)
    except EncodeError:
        return []
    kind, moment = type(source), bridge.now()
    messages: list[Any] = []
    compiled = _compiled(bridge, translate, connection, joins)

    def run(payload: bytes) -> bytes | None:
        message = _decoded(kind, payload)
        target = translate(message, **joins)
        encoded = None if target is None else _encoded(target)
        messages[:] = [message, target]
        return encoded

    vars(bridge)["now"] = lambda: moment
    try:
        _outcome(bridge, connection, lambda: run(data))
        sentences = [
            line for ros_message in messages for line in _differing_from_rclpy(ros_message)
        ]
        for variant in _variants(source, data):
            expected = _outcome(bridge, connection, partial(run, variant))
            outcome = _outcome(bridge, connection, partial(compiled, variant))
            if outcome not in (expected, (None, {})):
                comparison = f"by Python: {_shown(expected)}, compiled: {_shown(outcome)}"
                return [*sentences, f"of {variant.hex()}: {comparison}"]
    finally:
        del vars(bridge)["now"]
    return sentences


def _compiled(
    bridge: Bridge, translate: Callable[..., Any], connection: AnyConnection, joins: dict[str, Any]
) -> Callable[[bytes], bytes | None]:
    """Returns the compiled form, which gives way to everything where it is not built."""
    form = compiled_of(translate)
    if form is None or bridge.core is None:
        return _gives_way
    try:
        library = bridge.core.load()
    except NoCoreError:
        return _gives_way
    function = form.of(bridge, library, connection.drop_field.unknown)
    arguments = [None if joins[join] is None else _encoded(joins[join]) for join in form.joins]
    return lambda data: function(data, *arguments)


def _gives_way(_data: bytes) -> None:
    """Leaves a message to Python."""


def _variants(source: Any, data: bytes) -> Iterator[bytes]:
    """Yields an encoded message, those without an optional field, and what differs in one byte."""
    is_light = isinstance(source, LightMessage)
    for whole in (data, *(() if is_light else _without_a_field(source))):
        yield whole
        step = max(1, len(whole) * len(_VALUES) // _MOST_VARIANTS)
        for place in range(0 if is_light else CODE_SIZE, len(whole), step):
            for value in _VALUES:
                if whole[place] != value:
                    yield whole[:place] + bytes([value]) + whole[place + 1 :]


def _without_a_field(source: Any) -> Iterator[bytes]:
    for field in fields(source):
        if field.default is None and getattr(source, field.name) is not None:
            yield _encoded(replace(source, **{field.name: None}))


Outcome: TypeAlias = "tuple[bytes | str | None, dict[Any, int]]"


def _outcome(
    bridge: Bridge, connection: AnyConnection, make: Callable[[], bytes | None]
) -> Outcome:
    """What is made, or the name of the error, and what is counted; nothing stays of it."""
    memories, counts = dict(vars(bridge)), connection.statistics.out_of_range
    before = dict(counts)
    try:
        result: bytes | str | None = make()
    except (JausError, NotImplementedError) as error:  # the latter of a conversion not yet written
        result = type(error).__name__
    counted = {key: count - before.get(key, 0) for key, count in counts.items()}
    counts.clear()
    counts.update(before)
    vars(bridge).update(memories)
    return result, {key: count for key, count in counted.items() if count}


def _shown(outcome: Outcome) -> str:
    result, counted = outcome
    text = result.hex() if isinstance(result, bytes) else str(result)
    return f"{text} {counted}" if counted else text


def _encoded(message: Any) -> bytes:
    data: bytes = message.to_cdr() if isinstance(message, LightMessage) else message.encode()
    return data


def _decoded(kind: Any, data: bytes) -> Any:
    return kind.from_cdr(data) if issubclass(kind, LightMessage) else kind.decode(data)


def _differing_from_rclpy(message: Any) -> list[str]:
    """Has rclpy read a light message: what stands in it must be the same."""
    if not isinstance(message, LightMessage):
        return []
    try:
        from .ros.internals import Codec  # noqa: PLC0415 - there are tests without ROS

        codec = Codec(type(message))
    except (ImportError, RosTypeError):
        return []
    data = message.to_cdr()
    light, real = type(message).from_cdr(data), codec.decode(data)
    return list(_differences("", light, real))


def _differences(path: str, light: Any, real: Any) -> Iterator[str]:
    """What differs between a value of a light message and that of rclpy."""
    if isinstance(light, LightMessage):
        for name in light.LAYOUT:
            yield from _differences(f"{path}.{name}", getattr(light, name), getattr(real, name))
    elif isinstance(light, str) or not hasattr(light, "__len__"):
        of_ros = real[0] if isinstance(real, bytes) and not isinstance(light, str) else real
        if light != of_ros and (light == light or of_ros == of_ros):
            yield f"light{path}: {light!r}, rclpy: {real!r}"
    elif len(light) != len(real):
        yield f"light{path}: {len(light)} elements, rclpy: {len(real)}"
    else:
        for index, (one, other) in enumerate(zip(light, real, strict=True)):
            yield from _differences(f"{path}[{index}]", one, other)
