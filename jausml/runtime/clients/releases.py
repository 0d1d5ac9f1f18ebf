"""Releases of control that are under way: what is requested meanwhile would be lost by them."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ..messages import ReleaseControl

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from ..services.host import Host


class Releases:
    """Gives control back, and knows to whom that was not acknowledged yet.

    The transport repeats a ReleaseControl until it is acknowledged. A repetition that comes after
    a new request ends the control which that request has brought, so requests wait for it.
    """

    def __init__(self, component: Host, on_done: Callable[[JausAddress], None]) -> None:
        """Nothing is under way.

        Args:
            on_done: Told of each target to which nothing is under way any more.
        """
        self._component = component
        self._on_done = on_done
        self._under_way: dict[JausAddress, int] = {}

    def are_under_way(self, target: JausAddress) -> bool:
        """Return whether a target may still take a release that was sent."""
        return target in self._under_way

    def send(self, target: JausAddress, *, acknowledge: bool) -> None:
        """Send ReleaseControl.

        Args:
            acknowledge: Whether it is repeated until it is acknowledged.
        """
        if not acknowledge:
            self._component.send(ReleaseControl(), target)
            return
        self._under_way[target] = self._under_way.get(target, 0) + 1
        self._component.transport.send(
            self._component.address,
            target,
            ReleaseControl().encode(),
            acknowledge=True,
            on_result=partial(self._ended, target),
        )

    def _ended(self, target: JausAddress, _acknowledged: bool) -> None:  # noqa: FBT001
        left = self._under_way.pop(target) - 1
        if left:
            self._under_way[target] = left
        else:
            self._on_done(target)
