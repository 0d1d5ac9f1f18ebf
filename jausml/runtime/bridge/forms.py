"""Comparison of the forms of a translation, for the generated tests of a bridge."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ..base.errors import JausError
from ..wire.message import EncodeError
from .errors import RosTypeError
from .light_message import LightMessage
from .transcoding import transcoder_of, uses_ros_classes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from .bridge import Bridge
    from .connection import AnyConnection


def differing_forms(
    bridge: Bridge,
    translate: Callable[..., Any],
    connection: AnyConnection,
    source: Any,
    **joins: Any,
) -> list[str]:
    """Returns what the forms of a translation do not make alike of a message.

    The readable method is compared with its flat form, where it has one, and the light class of the
    ROS message with that of rclpy, where that is installed. The clock stands still meanwhile.

    Args:
        bridge: The bridge.
        translate: The translation, a method of the bridge.
        connection: Its connection.
        source: The message that is translated, a light one or a JAUS message.
        **joins: Messages of joined topics, or None.

    Returns:
        Sentences; nothing when all make the same, when there is no such source message, or when an
        override works on the classes of ROS.
    """
    if uses_ros_classes(translate):
        return []
    try:
        data = _encoded(source)
    except EncodeError:
        return []
    factory = transcoder_of(translate)
    moment = bridge.now()
    vars(bridge)["now"] = lambda: moment
    try:
        message = _decoded(type(source), data)
        target: list[Any] = []

        def readable() -> bytes | None:
            target.append(translate(message, **joins))
            return None if target[0] is None else _encoded(target[0])

        expected = _outcome(readable)
        found = []
        if factory is not None:
            flat = factory(bridge, connection)
            outcome = _outcome(lambda: flat(data, **joins))
            if outcome != expected:
                found.append(f"readable: {expected!r}, flat: {outcome!r}")
    finally:
        del vars(bridge)["now"]
    for each in (message, *target):
        if isinstance(each, LightMessage) and isinstance(expected, bytes):
            found += _differing_from_rclpy(each)
    return found


def _encoded(message: Any) -> bytes:
    data: bytes = message.to_cdr() if isinstance(message, LightMessage) else message.encode()
    return data


def _decoded(kind: Any, data: bytes) -> Any:
    return kind.from_cdr(data) if issubclass(kind, LightMessage) else kind.decode(data)


def _outcome(make: Callable[[], bytes | None]) -> bytes | str | None:
    """What is made, or the name of the error."""
    try:
        return make()
    except (JausError, NotImplementedError) as error:  # the latter of a conversion not yet written
        return type(error).__name__


def _differing_from_rclpy(message: LightMessage) -> list[str]:
    """Has rclpy read a light message: what stands in it must be the same."""
    try:
        from .ros_codec import Codec  # noqa: PLC0415 - there are tests without ROS

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
    elif isinstance(light, str) or not isinstance(light, Sequence):
        of_ros = real[0] if isinstance(real, bytes) and not isinstance(light, str) else real
        if light != of_ros and (light == light or of_ros == of_ros):
            yield f"light{path}: {light!r}, rclpy: {real!r}"
    elif len(light) != len(real):
        yield f"light{path}: {len(light)} elements, rclpy: {len(real)}"
    else:
        for index, (one, other) in enumerate(zip(light, real, strict=True)):
            yield from _differences(f"{path}[{index}]", one, other)
