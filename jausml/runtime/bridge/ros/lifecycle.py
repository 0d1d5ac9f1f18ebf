"""The managed node of rclpy under a bridge: `ros2 lifecycle` changes and shows its state."""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call, misc"

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn

from ...base.counters import LOGGER
from .parameters import LazyParameters

if TYPE_CHECKING:
    from collections.abc import Callable


class Managed(Protocol):
    """What transitions act on; each method raises what keeps it from the next state."""

    def configure(self) -> None:
        """From unconfigured to inactive."""

    def activate(self) -> None:
        """From inactive to active."""

    def deactivate(self) -> None:
        """From active to inactive."""

    def cleanup(self) -> None:
        """From inactive to unconfigured; no effect there."""

    def shut_down(self) -> None:
        """From any state to finalized."""


class ManagedNode(LazyParameters, LifecycleNode):
    """A node whose transitions bring something up and down."""

    def __init__(self, name: str, **options: Any) -> None:
        super().__init__(name, **options)
        self._managed: Managed | None = None
        self._error: BaseException | None = None
        self._is_asked = True  # by a service, whose answer says no more than that it failed

    def manage(self, managed: Managed) -> None:
        """Has transitions act on something from now on."""
        self._managed = managed

    def bring_up(self) -> None:
        """Goes from unconfigured to active at once.

        Raises:
            BaseException: What configuring or activating raised.
        """
        self._is_asked = False
        for trigger in (self.trigger_configure, self.trigger_activate):
            self._error = None
            if trigger() is not TransitionCallbackReturn.SUCCESS and self._error is not None:
                raise self._error
        self._is_asked = True

    def destroy_node(self) -> None:
        """Leaves ROS, and lets go of the state machine, which rclpy forgets."""
        super().destroy_node()
        self._state_machine.destroy_when_not_in_use()

    @property
    def state(self) -> str:
        """Name of the present state, e.g. `active`."""
        name: str = self._state_machine.current_state[1]
        return name

    def on_configure(self, state: Any) -> TransitionCallbackReturn:
        """Makes topics and the JAUS component."""
        del state
        return self._done(lambda managed: managed.configure())

    def on_activate(self, state: Any) -> TransitionCallbackReturn:
        """Lets messages pass."""
        del state
        return self._done(lambda managed: managed.activate())

    def on_deactivate(self, state: Any) -> TransitionCallbackReturn:
        """Lets nothing pass."""
        del state
        return self._done(lambda managed: managed.deactivate())

    def on_cleanup(self, state: Any) -> TransitionCallbackReturn:
        """Ends the JAUS component and gives topics back."""
        del state
        return self._done(lambda managed: managed.cleanup())

    def on_shutdown(self, state: Any) -> TransitionCallbackReturn:
        """Does the same for good, from any state."""
        del state
        return self._done(lambda managed: managed.shut_down())

    def _done(self, act: Callable[[Managed], None]) -> TransitionCallbackReturn:
        """Acts; a failure stays in the state before."""
        if self._managed is None:
            return TransitionCallbackReturn.SUCCESS
        try:
            act(self._managed)
        except BaseException as error:  # SystemExit of overridden methods too
            self._error = error
            if self._is_asked:
                LOGGER.error("%s: a transition failed: %s", self.get_fully_qualified_name(), error)
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS
