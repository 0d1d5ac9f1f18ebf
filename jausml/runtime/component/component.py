"""A JAUS component with all parts: what it provides to others and how it uses others."""

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
    """A component that can do whatever components can.

    A generated one derives from the bases alone that its model asks for, so that its workspace has
    no more than that. User code that goes further names another base, as in
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
    # They answer what comes unasked: events of a former life, and ends of former commands.
    clients = (EventClient, CommandClient, Greeter)
