"""Hooks of a component: what it calls on its own sub-class and a user overrides."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from datetime import datetime

    from ..base.address import JausAddress


class ComponentHooks:
    """Hooks of a component; they do nothing unless they are overridden, and must not block."""

    def on_initialize(self) -> None:
        """Prepare or reset the component: at the start and after Reset; Standby follows."""

    def on_ready(self) -> None:
        """The controller resumed the component: commands are obeyed from now on."""

    def on_not_ready(self) -> None:
        """The component left Ready, for whatever reason: stop all motion."""

    def on_control_lost(self) -> None:
        """The controller is the controller no more: what it commanded must not stand.

        It released control or let it lapse, a higher authority took over, or the component gave
        control up. The component may still be in Ready, for its new controller; where it was left,
        ``on_not_ready`` ran before. ``on_controller_changed`` follows.
        """

    def on_controller_changed(self, controller: JausAddress | None) -> None:
        """Another component controls this one, or none does (None)."""

    def on_emergency(self, active: bool) -> None:  # noqa: FBT001
        """An emergency was set, or the last one was cleared."""

    def on_shutdown(self) -> None:
        """The component entered Shutdown, by its controller's command or by ``stop``."""

    def on_set_time(self, time: datetime) -> None:
        """The controller has set the component's clock (AS5710, Time, SetTime).

        Args:
            time: What it was set to, in UTC. The host's clock is left as it is.
        """

    def on_list_changed(self) -> None:
        """The controller has changed ``elements`` (AS5710, ListManager)."""

    def core_state_changed(self) -> None:
        """The status changed, who controls the component, or whether control is to be had."""

    def core_event(self, name: str) -> None:
        """An internal event of a core service happened; for modelled state machines."""
