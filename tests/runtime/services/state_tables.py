"""Rows of the state tables of the core services, and how one row is played as a test.

A row names a situation, one thing that happens in it, and what must follow: who hears what, and
in which state the component is then. Nobody may hear anything that the row does not name.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import pytest

from jausml.runtime import JausComponent, ServiceIdentity
from jausml.runtime.messages import QueryServiceList, QueryServices, RequestControl, Resume
from jausml.runtime.wire.message import Message

V1_0, V1_1 = (1, 0), (1, 1)

Step = tuple[Any, ...] | Callable[["Stage"], object]
"""A message that a named peer sends to the component with what it is answered, or something done
to the component."""

CORE_NAMES = ("Transport", "Events", "AccessControl", "Management", "Time", "Liveness", "Discovery")


def core_services(version: tuple[int, int], *names: str) -> tuple[ServiceIdentity, ...]:
    """Returns core services of one version."""
    return tuple(ServiceIdentity(f"urn:jaus:jss:core:{name}", *version) for name in names)


@dataclass(frozen=True)
class Row:
    """One row of a table.

    Attributes:
        name: The row, as the test's id.
        given: What leads to the situation.
        when: What happens; a message is followed by what its sender hears, in order.
        then: What other peers hear, in order; those that are not named hear nothing.
        status: Status of the component afterwards, if the row tells.
        controller: Name of the controlling peer afterwards; "" for nobody; None if untold.
        authority: Authority code afterwards, if the row tells.
        counted: Name of the counter that counts it, if it is ignored.
        calls: Hooks of a `Robot` that are called meanwhile, in order, if the row tells.
        version: Version of the component's core services.
        settings: Settings of the component.
        services: Services next to the core services.
    """

    name: str
    given: tuple[Step, ...] = ()
    when: Step = lambda _stage: None
    then: dict[str, list[Any]] = field(default_factory=dict)
    status: int | None = None
    controller: str | None = None
    authority: int | None = None
    counted: str = ""
    calls: tuple[str, ...] | None = None
    version: tuple[int, int] = V1_1
    settings: dict[str, Any] = field(default_factory=dict)
    services: tuple[ServiceIdentity, ...] = ()


class Robot(JausComponent):
    """Keeps the calls of its hooks."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.calls = []

    def on_initialize(self):
        self.calls.append("initialize")

    def on_ready(self):
        self.calls.append("ready")

    def on_not_ready(self):
        self.calls.append("not ready")

    def on_control_lost(self):
        self.calls.append("control lost")

    def on_controller_changed(self, controller):
        self.calls.append(f"controller {controller}")

    def on_emergency(self, active):
        self.calls.append(f"emergency {active}")

    def on_shutdown(self):
        self.calls.append("shutdown")

    def take(self):
        calls, self.calls = self.calls, []
        return calls


class Stage:
    """A component and its peers: the client, a rival of it, and a bystander.

    Attributes:
        world: The network and the clock.
        component: The component under test, started.
        peers: The peers by name.
    """

    def __init__(self, world: Any, row: Row, kind: Any = None) -> None:
        services = core_services(row.version, *CORE_NAMES) + row.services
        arguments = {} if kind is None else {"kind": kind}
        self.world = world
        self.component = world.component("1.1.1", services=services, **arguments, **row.settings)
        self.peers = {
            name: world.probe(address)
            for name, address in (("client", "2.1.1"), ("rival", "3.1.1"), ("bystander", "4.1.1"))
        }
        self.component.start()

    def do(self, step: Step) -> None:
        """Does one step and lets everything settle that follows from it."""
        if callable(step):
            step(self)
        else:
            self.peers[step[0]].send(step[1], self.component)
        self.world.settle()

    def heard(self) -> dict[str, list[Message]]:
        """Returns and forgets what the peers heard; the silent ones are left out."""
        heard = {name: peer.take() for name, peer in self.peers.items()}
        return {name: messages for name, messages in heard.items() if messages}


def play(world: Any, row: Row, kind: Any = None) -> Stage:
    """Plays a row and checks all that it says; returns the stage for more checks."""
    stage = Stage(world, row, kind)
    for step in row.given:
        stage.do(step)
    stage.heard()
    before = world.counters.snapshot().get(row.counted, 0)
    called = 0 if row.calls is None else len(stage.component.calls)
    stage.do(row.when)
    heard = stage.heard()
    answers = {} if callable(row.when) or not row.when[2:] else {row.when[0]: [*row.when[2:]]}
    assert heard == {**answers, **row.then}, f"heard {heard}"
    component = stage.component
    if row.status is not None:
        assert component.status == row.status
    if row.controller is not None:
        names = {peer.address: name for name, peer in stage.peers.items()}
        assert names.get(component.controller, "") == row.controller
    if row.authority is not None:
        assert component.authority == row.authority
    if row.calls is not None:
        assert component.calls[called:] == list(row.calls)
    if row.counted:
        assert world.counters.snapshot().get(row.counted, 0) > before
    return stage


def rows(*table: Row) -> Any:
    """Parametrises a test with the rows of a table, each under its own name."""
    assert len({row.name for row in table}) == len(table)
    return pytest.mark.parametrize("row", table, ids=[row.name for row in table])


def unavailable(stage: Stage) -> None:
    """The component does not offer control."""
    stage.component.control_available = False


def after(seconds: float, steps: int = 8) -> Callable[[Stage], None]:
    """Lets time pass, in so many steps."""
    return lambda stage: stage.world.run(seconds, step=seconds / steps)


def query_services_of(*pairs: tuple[int, int]) -> QueryServices:
    """The query for the services of nodes and components."""
    query = QueryServices
    return query(
        [query.NodeSeq(query.NodeRec(node), [query.ComponentRec(one)]) for node, one in pairs]
    )


def query_service_list(subsystem: int, node=255, component=255, search=None) -> QueryServiceList:
    """The query for the services of subsystems, of which an address may have some words."""
    query = QueryServiceList
    components = [query.ComponentRec(component, search)]
    nodes = [query.NodeSeq(query.NodeRec(node), components)]
    return query([query.SubsystemSeq(query.SubsystemRec(subsystem), nodes)])


def controlled(authority: int = 50) -> tuple[Step, ...]:
    """The client controls the component, which is in Standby."""
    return (("client", RequestControl(authority_code=authority)),)


def ready(authority: int = 50) -> tuple[Step, ...]:
    """The client controls the component, which is Ready."""
    return (*controlled(authority), ("client", Resume()))
