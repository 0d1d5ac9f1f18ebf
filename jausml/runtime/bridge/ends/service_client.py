"""A service of ROS, and what calls it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..light_message import LightMessage


@dataclass(frozen=True)
class RosService:
    """A service of ROS.

    Attributes:
        type_name: Its type, e.g. `std_srvs/srv/SetBool`.
        success: Path of the bool of the response that tells whether all went well; may be empty.
        reason: Path of the text of the response that tells why not; may be empty.
    """

    name: str
    type_name: str
    request: type[LightMessage]
    response: type[LightMessage]
    success: str = ""
    reason: str = ""


class ServiceClient(Protocol):
    """Calls one service of ROS."""

    def is_ready(self) -> bool:
        """Whether somebody serves."""

    def call(self, request: bytes, answered: Callable[[bytes], None]) -> Callable[[], None]:
        """Calls the service.

        Args:
            answered: Is given the serialized response on the loop.

        Returns:
            What forgets the call.
        """
