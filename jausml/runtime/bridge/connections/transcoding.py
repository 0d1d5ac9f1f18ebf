"""How connections run translations: from bytes to bytes, by a method on objects in between.

Those of ROS messages are of the light classes of the bridge package, or of the classes of ROS if
`ros_classes` asks for them.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from types import MethodType
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from ...services.dispatch import LONGEST_CALL
from ..light_message import is_light

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..ends.ros_side import RosSide
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
    names = [
        each.__name__
        for each in translations
        if isinstance(each, MethodType)
        and sum(each.__name__ in vars(kind) for kind in type(each.__self__).__mro__) > 1
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
            elapsed = clock() - begun
            if elapsed > LONGEST_CALL:
                on_blocking(elapsed)
        return None if target is None else encode(target)

    return transcode


def compiled_first(function: Function, names: Sequence[str], slow: Transcode) -> Transcode:
    """Returns a translation that asks a function first.

    Args:
        names: The joins, in the order in which the function is given them.
        slow: Treats what is not usual; is given the messages of joins.
    """
    if not names:

        def transcode(data: bytes) -> bytes | None:
            made = function(data)
            return slow(data) if made is None else made

        return transcode

    def transcode_joined(data: bytes, **joins: Any) -> bytes | None:
        made = function(data, *(joins[name].fresh_data() for name in names))
        if made is not None:
            return made
        return slow(data, **{name: each.fresh() for name, each in joins.items()})

    return transcode_joined


def ros_decoder(ros: RosSide, message_type: type[Any], *, real: bool) -> Callable[[bytes], Any]:
    """Returns what makes objects of serialized ROS messages.

    Args:
        message_type: A light class, or a message class of ROS.
    """
    if real or not is_light(message_type):
        return ros.codec(message_type).decode
    return message_type.from_cdr


def ros_encoder(ros: RosSide, message_type: type[Any]) -> Callable[[Any], bytes]:
    """Returns what serializes ROS messages, be they light or of the message class of ROS.

    Args:
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
