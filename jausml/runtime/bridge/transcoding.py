"""Forms of a translation: flat from bytes to bytes, or a method on objects.

The generated base decorates its readable methods with `transcoded`: a connection then runs the flat
form instead. A method that overrides one has no such mark, and so is called itself: on the light
classes of the bridge package, or on those of ROS if `ros_classes` asks for them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

if TYPE_CHECKING:
    from .connection import AnyConnection

    TranscoderFactory: TypeAlias = Callable[[Any, AnyConnection], "Transcode"]

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
    factory: TranscoderFactory | None = getattr(translate, "transcoder", None)
    return factory


def uses_ros_classes(translate: Callable[..., Any]) -> bool:
    """Whether a translation wants objects of the message classes of ROS."""
    return getattr(translate, "uses_ros_classes", False) is True
