"""Comparison of the forms of a translation, for the generated tests of a bridge."""

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

CODE_SIZE = 2  # bytes of the message code, which stay in all variants

# Put into each byte of a message: they make small and great numbers, other lengths and presences.
_VALUES = (0x00, 0x01, 0x7F, 0x80, 0xFF)
_MAX_VARIANTS = 1000  # tried of one message; a large one is changed at fewer positions


def differing_forms(
    bridge: Bridge,
    translate: Callable[..., Any],
    connection: AnyConnection,
    source: Any,
    **joins: Any,
) -> list[str]:
    """Returns how the forms of a translation differ for a message and variants of it.

    The compiled form is compared with Python: their target messages, errors, and counts of values
    out of range. It may also leave a message to Python. A variant lacks an optional field, or has
    another value in one byte. The light class of the ROS message is compared with that of rclpy, if
    that is installed. The clock stands still meanwhile.

    Args:
        source: A source message.
        **joins: Messages of joined topics, or None.

    Returns:
        Sentences, at most one on the compiled form. None when all forms agree, when the source
        cannot be encoded, or when an override works on the classes of ROS.
    """
    if uses_ros_classes(translate):
        return []
    try:
        data = _encoded(source)
    except EncodeError:
        return []
    kind = type(source)
    messages: list[Any] = []
    compiled = _compiled(bridge, translate, connection, joins)

    def run(payload: bytes) -> bytes | None:
        message = _decoded(kind, payload)
        target = translate(message, **joins)
        encoded = None if target is None else _encoded(target)
        messages[:] = [message, target]
        return encoded

    with bridge.frozen_at(bridge.now()):
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
    return sentences


def _compiled(
    bridge: Bridge, translate: Callable[..., Any], connection: AnyConnection, joins: dict[str, Any]
) -> Callable[[bytes], bytes | None]:
    """Returns the compiled function of a translation; without one, `_leave_to_python`."""
    form = compiled_of(translate)
    if form is None or bridge.core is None:
        return _leave_to_python
    try:
        library = bridge.core.load()
    except NoCoreError:
        return _leave_to_python
    function = form.of(bridge, library, connection.drop_field.unknown)
    arguments = [None if joins[join] is None else _encoded(joins[join]) for join in form.joins]
    return lambda data: function(data, *arguments)


def _leave_to_python(_data: bytes) -> None:
    """Returns None, as the compiled form does for a message that it leaves to Python."""


def _variants(source: Any, data: bytes) -> Iterator[bytes]:
    """Yields an encoded message, ones without an optional field, and ones with another byte."""
    is_light = isinstance(source, LightMessage)
    for whole in (data, *(() if is_light else _without_a_field(source))):
        yield whole
        step = max(1, len(whole) * len(_VALUES) // _MAX_VARIANTS)
        for position in range(0 if is_light else CODE_SIZE, len(whole), step):
            for value in _VALUES:
                if whole[position] != value:
                    yield whole[:position] + bytes([value]) + whole[position + 1 :]


def _without_a_field(source: Any) -> Iterator[bytes]:
    for field in fields(source):
        if field.default is None and getattr(source, field.name) is not None:
            yield _encoded(replace(source, **{field.name: None}))


Outcome: TypeAlias = "tuple[bytes | str | None, dict[Any, int]]"


def _outcome(
    bridge: Bridge, connection: AnyConnection, translate: Callable[[], bytes | None]
) -> Outcome:
    """Returns the target message, or the name of the error, and the counts of a translation.

    Attributes of the bridge and counts are restored.
    """
    attributes, counts = dict(vars(bridge)), connection.statistics.out_of_range
    before = dict(counts)
    try:
        result: bytes | str | None = translate()
    except (JausError, NotImplementedError) as error:  # the latter of a conversion not yet written
        result = type(error).__name__
    counted = {key: count - before.get(key, 0) for key, count in counts.items()}
    counts.clear()
    counts.update(before)
    vars(bridge).update(attributes)
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
    """Returns how a light message differs from the same bytes as decoded by rclpy."""
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
    """Yields how a value of a light message differs from that of rclpy."""
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
