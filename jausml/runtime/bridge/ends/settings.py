"""Settings of a bridge as the model states them, apart from its connections."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ...base.settings import TransportSettings
from ...component.base import COMPONENT_TYPE
from ...services.definitions import ComponentSettings, ServiceIdentity

if TYPE_CHECKING:
    from ...base.address import JausAddress


@dataclass(frozen=True)
class BridgeSettings:
    """What the model says about a bridge, apart from its connections.

    Attributes:
        frequency: Messages each second where the model states no rate. Diagnostics come at this
            rate too, but not more often than once a second.
        services: Services that the bridge provides, inherited ones included.
        authority: Authority code that control is requested with, 0 to 255.
        guardian: Whether a small process beside the bridge says its stops when the bridge cannot.
    """

    name: str
    address: JausAddress
    description: str = ""
    namespace: str = ""
    frequency: float = 1.0
    services: tuple[ServiceIdentity, ...] = ()
    component_type: int = COMPONENT_TYPE
    authority: int = 127
    component: ComponentSettings = field(default_factory=ComponentSettings)
    transport: TransportSettings = field(default_factory=TransportSettings)
    guardian: bool = True
