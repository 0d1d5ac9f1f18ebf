"""The JAUS component with all core services and clients."""

from __future__ import annotations

from ..clients.command_client import CommandClient, Commander
from ..clients.event_client import EventClient
from ..clients.found_peers import PeerQuerier, PeerSubscriber
from ..clients.greeter import Greeter
from ..clients.list_client import ListEditor
from ..clients.peer_controller import PeerController
from ..clients.peer_search import PeerFinder
from ..services.digital_resources import DigitalResourceService
from ..services.handoff import HandoffService
from ..services.list_manager import ListHolder, ListManagerService
from ..services.machine_states import MachineStatesService
from ..services.time_of_day import TimeService
from .base import Component


class JausComponent(
    PeerSubscriber,
    PeerQuerier,
    PeerController,
    PeerFinder,
    Commander,
    ListEditor,
    ListHolder,
    Component,
):
    """A component with all core services and clients.

    A generated component only derives from the bases that its model needs, so that its workspace
    contains no others. User code that needs more adds a base, as in
    ``class Lamp(Querier, LampBase)``, or this class for all of them.
    """

    core_services = (
        *Component.core_services,
        HandoffService,
        ListManagerService,
        TimeService,
        DigitalResourceService,
        MachineStatesService,
    )
    # Made at the start, to cancel events and command events of an earlier process.
    clients = (EventClient, CommandClient, Greeter)
