"""Services of components that know no wildcards: they are asked once more, by their own id."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..base.quirks import Quirk
from ..services.discovery_messages import query_services_of

if TYPE_CHECKING:
    from ..base.address import JausAddress
    from ..messages import ReportServices
    from ..services.host import Host

INTERVAL = 5.0
"""Seconds after which a component that reports nothing is asked again."""

_MOST_ASKED = 4096


class AskingById:
    """Asks who reports no component to a query with wildcards for its own services."""

    def __init__(self, component: Host) -> None:
        self._component = component
        self._asked: dict[JausAddress, float] = {}

    def take(self, report: ReportServices, sender: JausAddress) -> None:
        """Ask if a report is empty; learn of who reports something then."""
        now = self._component.loop.now()
        asked = self._asked.get(sender, -math.inf)
        if any(node.component_list for node in report.node_list):
            if now < asked + INTERVAL:
                quirks = self._component.transport.quirks
                quirks.learn(sender, Quirk.NO_WILDCARDS, "it reported nothing to a wildcard")
            return
        if now < asked + INTERVAL:
            return
        if len(self._asked) >= _MOST_ASKED:
            self._asked.clear()
        self._asked[sender] = now
        self._component.send(query_services_of(sender), sender)
