"""Translations as connections, calls and lists run them: from bytes to bytes, with joined messages.

A translation method works on objects in between. ROS messages are objects of the light classes of
the bridge package, or of the classes of ROS for a method marked by `ros_classes`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum
from types import MethodType
from typing import Any, Protocol, TypeAlias, TypeVar

from ...services.dispatch import LONGEST_CALL
from ..ends.ros_side import RosSide
from ..light_message import is_light
from ..messages.compiled import Function

# Returns the encoded target message of an encoded source message; None for no message. It is given
# joins by name: their messages, or each `Joined` itself where `compiled_first` returned it.
Transcode: TypeAlias = Callable[..., bytes | None]

MethodT = TypeVar("MethodT", bound=Callable[..., Any])


def ros_classes(method: MethodT) -> MethodT:
    """Decorates a translation that works on objects of the message classes of ROS."""
    vars(method)["uses_ros_classes"] = True
    return method


def uses_ros_classes(translate: Callable[..., Any]) -> bool:
    """Returns whether a translation is marked by `ros_classes`."""
    return getattr(translate, "uses_ros_classes", False) is True


def override_of(*translations: object) -> list[tuple[str, str]]:
    """Returns the entry of diagnostics that names overridden translations; empty without any."""
    methods = [method for method in translations if isinstance(method, MethodType)]
    names = ", ".join(method.__name__ for method in methods if _is_overridden(method))
    return [("override", names)] if names else []


def _is_overridden(method: MethodType) -> bool:
    """Returns whether two classes define a method: a subclass has replaced the generated one."""
    classes = type(method.__self__).__mro__
    return sum(method.__name__ in vars(base) for base in classes) > 1


class Form(Enum):
    """Form of the messages in a translation; diagnostics show the value."""

    LIGHT = "light classes"
    ROS_CLASSES = "ROS classes"
    COMPILED = "compiled"


def transcoder(
    translate: Callable[..., Any],
    decode: Callable[[bytes], Any],
    encode: Callable[[Any], bytes],
    on_blocking: Callable[[float], None],
    clock: Callable[[], float],
) -> Transcode:
    """Returns a function that decodes, translates and encodes; it raises what these raise.

    Args:
        translate: Returns the target object, or None to pass nothing on.
        decode: Returns the source object; raises DecodeError.
        encode: Encodes the target object; raises EncodeError.
        on_blocking: Called with the seconds of a translation that blocked the loop for too long.
        clock: Returns seconds.
    """

    def transcode(data: bytes, **joins: Any) -> bytes | None:
        begun = clock()
        try:
            target = translate(decode(data), **joins)
        finally:
            # Also for a translation that fails: the loop was blocked all the same.
            elapsed = clock() - begun
            if elapsed > LONGEST_CALL:
                on_blocking(elapsed)
        return None if target is None else encode(target)

    return transcode


def compiled_first(function: Function, names: Sequence[str], slow: Transcode) -> Transcode:
    """Returns a translation by a compiled function, or by `slow` where the function returns None.

    The function takes the messages of joins in the order of their names.
    """
    if not names:

        def transcode(data: bytes) -> bytes | None:
            target = function(data)
            return slow(data) if target is None else target

        return transcode

    def transcode_joined(data: bytes, **joins: Any) -> bytes | None:
        target = function(data, *(joins[name].fresh_data() for name in names))
        if target is not None:
            return target
        # Only `slow` needs the messages of joins as objects.
        return slow(data, **{name: join.fresh() for name, join in joins.items()})

    return transcode_joined


def ros_decoder(
    ros: RosSide, message_type: type[Any], translate: Callable[..., Any]
) -> Callable[[bytes], Any]:
    """Returns the decoder of serialized messages, to the objects that a translation works on."""
    if uses_ros_classes(translate) or not is_light(message_type):
        return ros.codec(message_type).decode
    return message_type.from_cdr


def ros_encoder(ros: RosSide, message_type: type[Any]) -> Callable[[Any], bytes]:
    """Returns the encoder of ROS messages; it takes light objects and those of ROS."""
    if not is_light(message_type):
        return ros.codec(message_type).encode
    encode: Callable[[Any], bytes] | None = None

    def encode_either(message: Any) -> bytes:
        nonlocal encode
        if isinstance(message, message_type):
            return message.to_cdr()
        # Made for the first object of the class of ROS, since it imports rclpy.
        if encode is None:
            encode = ros.codec(message_type).encode
        # rclpy leaves octets unwritten behind an empty sequence of float64, and where it pads. They
        # may hold anything of this process, so the message is serialized anew without them.
        return message_type.from_cdr(encode(message)).to_cdr()

    return encode_either


class Joined(Protocol):
    """The latest message of a join; `joins.Latest` implements it."""

    name: str

    def fresh(self) -> Any:
        """Returns the message, decoded; None or a StaleJoinError when it is not fresh."""

    def fresh_data(self) -> bytes | None:
        """Returns the message as bytes; None or a StaleJoinError when it is not fresh."""

    @property
    def age(self) -> float | None:
        """Seconds since the message arrived; None before the first."""

    @property
    def is_stale(self) -> bool:
        """Whether there is no fresh message."""


def with_joins(
    transcode: Transcode, joined: Sequence[Joined], *, is_compiled: bool = False
) -> Transcode:
    """Returns a translation of bytes alone, which adds the messages of joins.

    A compiled one is given the joins themselves, as it may need their bytes only.
    """
    if is_compiled:
        joins = {join.name: join for join in joined}
        return lambda data: transcode(data, **joins)

    def transcode_joined(data: bytes) -> bytes | None:
        return transcode(data, **{join.name: join.fresh() for join in joined})

    return transcode_joined
