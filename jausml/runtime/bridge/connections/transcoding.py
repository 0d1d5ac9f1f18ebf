"""Forms of a translation: flat from bytes to bytes, or a method on objects.

The generated base decorates its readable methods with `transcoded`: a connection then runs the flat
form instead. A method that overrides one has no such mark, and so is called itself: on the light
classes of the bridge package, or on those of ROS if `ros_classes` asks for them.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from ...services.dispatch import LONGEST_CALL
from ..light_message import is_light

if TYPE_CHECKING:
    from ..ends.ends import RosSide

    TranscoderFactory: TypeAlias = Callable[[Any, Any], "Transcode"]

Transcode: TypeAlias = Callable[..., bytes | None]
"""Makes encoded target messages of encoded source messages, or None to pass nothing on."""

MethodT = TypeVar("MethodT", bound=Callable[..., Any])


def transcoded(factory: TranscoderFactory) -> Callable[[MethodT], MethodT]:
    """Names the flat form of a translation, which passes the same on as the decorated method.

    Args:
        factory: Makes the flat form for a bridge and a connection.
    """

    def mark(method: MethodT) -> MethodT:
        vars(method)["transcoder"] = factory
        return method

    return mark


def ros_classes(method: MethodT) -> MethodT:
    """Has a translation given, or lets it make, objects of the message classes of ROS."""
    vars(method)["uses_ros_classes"] = True
    return method


def transcoder_of(translate: Callable[..., Any]) -> TranscoderFactory | None:
    """Returns what makes the flat form of a translation; None when it has none."""
    if hasattr(translate, "__wrapped__"):
        return None  # the mark is that of the method which it wraps, and takes the attributes of
    factory: TranscoderFactory | None = getattr(translate, "transcoder", None)
    return factory


def uses_ros_classes(translate: Callable[..., Any]) -> bool:
    """Whether a translation wants objects of the message classes of ROS."""
    return getattr(translate, "uses_ros_classes", False) is True


class Form(Enum):
    """Form in which the translation of a connection runs; the value is what diagnostics say."""

    FLAT = "flat"
    LIGHT = "light classes"
    ROS_CLASSES = "ROS classes"


def readable(
    translate: Callable[..., Any],
    decode: Callable[[bytes], Any],
    encode: Callable[[Any], bytes],
    on_blocking: Callable[[float], None],
    clock: Callable[[], float],
) -> Transcode:
    """Returns what runs a translation on objects.

    Args:
        translate: Makes the target object, or None to pass nothing on.
        decode: Makes the source object; raises DecodeError.
        encode: Encodes the target object; raises EncodeError.
        on_blocking: Told the seconds of a translation that takes long: nothing else goes on then.
        clock: Tells the seconds that it takes.
    """

    def transcode(data: bytes, **joins: Any) -> bytes | None:
        begun = clock()
        try:
            target = translate(decode(data), **joins)
        finally:
            elapsed = clock() - begun
            if elapsed > LONGEST_CALL:
                on_blocking(elapsed)
        return None if target is None else encode(target)

    return transcode


def ros_decoder(ros: RosSide, message_type: type[Any], *, real: bool) -> Callable[[bytes], Any]:
    """Returns what makes objects of serialized ROS messages.

    Args:
        ros: The ROS side.
        message_type: A light class, or a message class of ROS.
        real: Whether objects of the message class of ROS are wanted anyway.
    """
    if real or not is_light(message_type):
        return ros.codec(message_type).decode
    return message_type.from_cdr


def ros_encoder(ros: RosSide, message_type: type[Any]) -> Callable[[Any], bytes]:
    """Returns what serializes ROS messages, be they light or of the message class of ROS.

    Args:
        ros: The ROS side.
        message_type: A light class, or a message class of ROS.
    """
    if not is_light(message_type):
        return ros.codec(message_type).encode
    encode: Callable[[Any], bytes] | None = None

    def encode_either(message: Any) -> bytes:
        nonlocal encode
        if isinstance(message, message_type):
            return message.to_cdr()
        if encode is None:
            encode = ros.codec(message_type).encode
        return encode(message)

    return encode_either
