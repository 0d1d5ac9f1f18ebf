"""Translations as connections run them: from bytes to bytes, with joined messages at hand.

Between the bytes stand objects for a method: those of ROS messages are of the light classes of the
bridge package, or of the classes of ROS if `ros_classes` asks for them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from types import MethodType
from typing import Any, Protocol, TypeAlias, TypeVar

from ...services.dispatch import LONGEST_CALL
from ..ends.ros_side import RosSide
from ..light_message import is_light
from ..messages.compiled import Function

Transcode: TypeAlias = Callable[..., bytes | None]
"""Makes encoded target messages of encoded source messages, or None to pass nothing on."""

MethodT = TypeVar("MethodT", bound=Callable[..., Any])


def ros_classes(method: MethodT) -> MethodT:
    """Has a translation given, or lets it make, objects of the message classes of ROS."""
    vars(method)["uses_ros_classes"] = True
    return method


def uses_ros_classes(translate: Callable[..., Any]) -> bool:
    """Whether a translation wants objects of the message classes of ROS."""
    return getattr(translate, "uses_ros_classes", False) is True


def override_of(*translations: object) -> list[tuple[str, str]]:
    """Names the methods among translations that a subclass has in the place of generated ones."""
    # Where two classes of its line define a method, a subclass has replaced the generated one.
    names = [
        translation.__name__
        for translation in translations
        if isinstance(translation, MethodType)
        and sum(translation.__name__ in vars(kind) for kind in type(translation.__self__).__mro__)
        > 1
    ]
    return [("override", ", ".join(names))] if names else []


class Form(Enum):
    """What the translation of a connection works on; the value is what diagnostics say."""

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
    """Returns what runs a translation from bytes to bytes.

    Args:
        translate: Makes the target object, or None to pass nothing on.
        decode: Makes the source object; raises DecodeError.
        encode: Encodes the target object; raises EncodeError.
        on_blocking: Told the seconds of a translation that takes long: nothing else goes on then.
    """

    def transcode(data: bytes, **joins: Any) -> bytes | None:
        begun = clock()
        try:
            target = translate(decode(data), **joins)
        finally:
            # Also of a translation that fails: the loop was held up all the same.
            elapsed = clock() - begun
            if elapsed > LONGEST_CALL:
                on_blocking(elapsed)
        return None if target is None else encode(target)

    return transcode


def compiled_first(function: Function, names: Sequence[str], slow: Transcode) -> Transcode:
    """Returns a translation that asks a function first, which takes the joins in order of names."""
    if not names:

        def transcode(data: bytes) -> bytes | None:
            target = function(data)
            return slow(data) if target is None else target

        return transcode

    def transcode_joined(data: bytes, **joins: Any) -> bytes | None:
        target = function(data, *(joins[name].fresh_data() for name in names))
        if target is not None:
            return target
        # Objects of joins are made only here, where the function has given way.
        return slow(data, **{name: join.fresh() for name, join in joins.items()})

    return transcode_joined


def ros_decoder(ros: RosSide, message_type: type[Any], *, real: bool) -> Callable[[bytes], Any]:
    """Returns what makes objects, light or of the message class of ROS, of serialized messages."""
    if real or not is_light(message_type):
        return ros.codec(message_type).decode
    return message_type.from_cdr


def ros_encoder(ros: RosSide, message_type: type[Any]) -> Callable[[Any], bytes]:
    """Returns what serializes ROS messages, be they light or of the message class of ROS."""
    if not is_light(message_type):
        return ros.codec(message_type).encode
    encode: Callable[[Any], bytes] | None = None

    def encode_either(message: Any) -> bytes:
        nonlocal encode
        if isinstance(message, message_type):
            return message.to_cdr()
        # Made for the first object of the class of ROS: rclpy need not be there before.
        if encode is None:
            encode = ros.codec(message_type).encode
        # What rclpy serializes is as long as it has estimated: behind an empty sequence of float64,
        # and where it pads, are octets that nobody has written. They are not for others to read.
        return message_type.from_cdr(encode(message)).to_cdr()

    return encode_either


@dataclass(frozen=True)
class NamedPlaces:
    """Elements that a translation takes by place, and that messages have in any order."""

    keys: str  # the field with the name of each element, such as `name` of sensor_msgs/JointState
    names: tuple[str, ...]  # the names, in the order of the places
    arrays: tuple[str, ...]  # the fields whose elements the translation takes

    def ordered(self, source: Any, by_name: Callable[..., list[Any]]) -> Any:
        """Returns a message with its elements in order; one that names none is as it should be.

        Args:
            by_name: Returns values in the order of names, and raises AbsentFieldError.
        """
        keys = getattr(source, self.keys)
        if len(keys):
            for array in self.arrays:
                values = by_name(self.names, keys, getattr(source, array), array)
                setattr(source, array, values)
            setattr(source, self.keys, list(self.names))
        return source


class Joined(Protocol):
    """The latest message of a join; `joins.py` has those of models with joins."""

    name: str

    def fresh(self) -> Any:
        """Returns the message, or None or a StaleJoinError when there is nothing fresh."""

    def fresh_data(self) -> bytes | None:
        """Returns the message as it came."""

    @property
    def age(self) -> float | None:
        """Seconds since it arrived; None before the first."""

    @property
    def is_stale(self) -> bool:
        """Whether there is nothing fresh."""


def with_joins(
    transcode: Transcode, joined: Sequence[Joined], *, is_compiled: bool = False
) -> Transcode:
    """Returns a translation with the messages of joins; one that is compiled asks them itself."""
    if is_compiled:
        asked = {join.name: join for join in joined}
        return lambda data: transcode(data, **asked)

    def transcode_joined(data: bytes) -> bytes | None:
        return transcode(data, **{join.name: join.fresh() for join in joined})

    return transcode_joined
