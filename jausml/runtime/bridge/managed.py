"""A bridge as a managed node: what each transition of its life cycle does on both sides."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from ..base.counters import LOGGER

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..transports.transport import Transport
    from .bridge import Bridge
    from .ends.ends import RosSide


class ReleasableRosSide(Protocol):
    """What transitions need of the ROS side beyond what a bridge does; `RosNode` has it."""

    def listen(self) -> None:
        """Begins to take messages of what was subscribed to."""

    def release(self) -> None:
        """Gives all topics back."""


class ManagedBridge:
    """Brings a bridge up and down in steps (ROS 2 design, managed nodes).

    | state | on ROS | on JAUS |
    |---|---|---|
    | unconfigured | no topics | no component |
    | inactive | topics, nothing passes | Standby; control is not available |
    | active | messages pass | Standby, Ready or Emergency, as its controller says |
    | finalized | no topics | Shutdown was told, no component |

    Every method ends in the state before when it raises.
    """

    def __init__(
        self,
        bridge: Bridge,
        ros: RosSide,
        topics: ReleasableRosSide,
        transport: Transport,
        end: Callable[[str], None],
    ) -> None:
        self._bridge = bridge
        self._ros = ros
        self._topics = topics
        self._transport = transport
        self._end = end
        self._is_closing = False

    def configure(self) -> None:
        """Makes topics and the JAUS component; nothing passes yet."""
        try:
            self._bridge.open(self._ros, self._transport, active=False)
        except BaseException:
            self._bridge.close()
            self._topics.release()
            raise
        self._bridge.component.when_shut_down(self._note_shutdown)
        self._topics.listen()

    def activate(self) -> None:
        """Lets messages pass."""
        self._bridge.set_active(True)
        LOGGER.info("%s runs as %s", self._ros.name, self._bridge.settings.address)

    def deactivate(self) -> None:
        """Stops what is commanded, gives control back, and lets nothing pass."""
        self._bridge.set_active(False)
        LOGGER.info("%s is inactive", self._ros.name)

    def cleanup(self) -> None:
        """Ends the JAUS component and gives the topics back."""
        self._is_closing = True
        try:
            # JAUS first: stops are sent and control is released while ROS still delivers.
            self._bridge.close()
        finally:
            self._is_closing = False
        self._topics.release()

    def shut_down(self) -> None:
        """Does the same for good: a process without a bridge in it is of no use."""
        self.cleanup()
        self._end("shutdown of the node")

    def _note_shutdown(self) -> None:
        if not self._is_closing:
            self._end("JAUS Shutdown")
