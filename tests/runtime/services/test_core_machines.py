"""The core services do what their machines say (AS5710A): each transition is played.

The library has these machines. Where the definitions of others are there, it is held against them,
and always against the runtime. What the runtime does otherwise is `OTHERWISE`.
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import pytest
from for_each import for_each
from needs import SHARED

from jausml.language.attributes.guards import alternatives, parse_guard
from jausml.language.importers.jsidl import import_jsidl
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.jaus.core_services import newest_services
from jausml.language.semantics.jaus.inherited_machines import core_machine, states_of
from jausml.runtime import Completion, JausComponent, Scope, ServiceIdentity, Status
from jausml.runtime import messages as core
from jausml.runtime.clients.discovery_client import query_service_lists, query_services
from jausml.runtime.component.modelled import CORE_STATES
from jausml.runtime.services.discovery import register_services

from .conftest import World
from .state_tables import Row, Stage, after, controlled, ready

OF_OTHERS = "jsidl/urn.jaus.jss.core-v1.1"
SERVICES = ("AccessControl", "Discovery", "Events", "Liveness", "Management")


class Transition(NamedTuple):
    """A line of the table."""

    service: str
    state: str
    trigger: str
    guard: str
    target: str
    sent: str

    @property
    def path(self) -> str:
        """The state from the outermost one."""
        inside = self.state.removesuffix(" *").strip("-")
        return f"{READY}.{inside}" if inside else READY

    def holds_in(self, leaf: str) -> bool:
        """Tells whether it holds in an innermost state, as no inner state has the trigger."""
        inner = (
            row for row in TABLE if row.trigger == self.trigger and len(row.path) > len(self.path)
        )
        return lies_in(leaf, self.path) and not any(lies_in(leaf, row.path) for row in inner)


READY = "Receiving.Ready"


def lies_in(path: str, outer: str) -> bool:
    return path == outer or path.startswith(f"{outer}.")


# -- the library and the definitions of others ----------------------------------------------------


def transitions(services: Iterable[jaus.Service]) -> Iterator[Transition]:
    """Yields the transitions of core services."""
    for service in services:
        for machine in (
            state_machine
            for state_machine in service.machines
            if state_machine.name == "ReceiveFSM"
        ):
            for path, state in states_of(machine):
                inside = path.removeprefix(READY).strip(".") or "-"
                for name, of_state in (
                    (inside, state.transitions),
                    (f"{inside} *", state.defaults),
                ):
                    for element in of_state:
                        yield transition(service.name, name, element)


def transition(service, state, element) -> Transition:
    sent = []
    for action in element.actions:
        quoted = [argument.strip("'") for argument in action.arguments if argument.startswith("'")]
        if quoted or action.name.startswith("send"):
            sent.append(" ".join(quoted) or action.name.removeprefix("send"))
    guard = (element.guard or "-").replace("(msg)", "").replace("(transportData)", "")
    target = (element.target or "-").removeprefix(f"{READY}.")
    return Transition(
        service,
        state,
        element.message.name if element.message is not None else element.event,
        guard.replace("()", ""),
        "before" if element.kind.name == "pop" else target,
        ", ".join(sent) or "-",
    )


TABLE = list(
    transitions(
        newest_service
        for newest_service in newest_services().values()
        if newest_service.name in SERVICES
    )
)


@pytest.mark.beside(OF_OTHERS)
def test_the_library_is_as_the_definitions_of_others():
    result = import_jsidl(sorted((SHARED / OF_OTHERS).rglob("*.xml")))
    services = [
        service for root in result.sets for service in root.services if service.name in SERVICES
    ]
    assert len(TABLE) == 67
    assert sorted(transitions(services)) == sorted(TABLE)


def test_transitions_lead_to_states_that_models_refine():
    states = core_machine(None).states
    for row in TABLE:
        assert row.path in states
        assert row.target in ("-", "before") or f"{READY}.{row.target}" in states
    assert {CORE_STATES[situation] for situation in SITUATIONS} == {*core_machine(None).leaves} - {
        INIT
    }


# -- the runtime ----------------------------------------------------------------------------------


class Robot(JausComponent):
    """Has a command that takes time."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.under_way = []
        self.handle(SlowCommand, self.on_slow)

    def on_slow(self, _message, _sender):
        self.under_way.append(Completion())
        return self.under_way[-1]


class SlowCommand(core.SetAuthority):
    """A command of the user that takes time."""

    CODE = 0x1F00
    NAME = "SlowCommand"


def fails(stage):
    stage.component.fail("a motor is broken")


INIT = f"{READY}.NotControlled.NotAvailable.Init"
STANDBY = "NotControlled.Available.Standby"
FAILURE = "NotControlled.NotAvailable.Failure"
EMERGENCY = ("bystander", core.SetEmergency())
SITUATIONS = {
    (Status.STANDBY, False): (),
    (Status.FAILURE, False): (fails,),
    (Status.SHUTDOWN, False): (*ready(), ("client", core.Shutdown())),
    (Status.EMERGENCY, False): (EMERGENCY,),
    (Status.STANDBY, True): controlled(),
    (Status.READY, True): ready(),
    (Status.EMERGENCY, True): (*ready(), EMERGENCY),
}
"""What leads to each innermost state but Init, which a component passes through at its start."""


STATUS = core.QueryStatus().encode()


def create(query=STATUS, rate=0.0):
    return core.CreateEvent(
        request_id=7, event_type=0 if rate else 1, requested_periodic_rate=rate, query_message=query
    )


def update(event, query=STATUS):
    return core.UpdateEvent(
        request_id=8, event_type=1, requested_periodic_rate=0.0, event_id=event, query_message=query
    )


def command(payload):
    return core.CreateCommandEvent(
        request_id=5, maximum_allowed_duration=1, command_message=payload
    )


SLOW = SlowCommand(authority_code=1).encode()
UNKNOWN = b"\xff\x2f"
EXISTING = {
    "CommandExpired": command(SLOW),
    "CommandCompleted": command(SLOW),
    "CreateCommandEvent": command(SLOW),
    "EventOccurred": create(rate=1.0),
}
"""What exists already when a trigger comes; for the others of Events one on every change."""

OCCASIONS = {
    "Timedout": after(4.1),
    "Failure": fails,
    "EventOccurred": after(1.05),
    "Timeout": after(130.0, steps=40),
    "CommandExpired": after(2.0),
    "CommandCompleted": lambda stage: stage.component.under_way[-1].succeed(),
}
"""How internal events come about."""


def asked(trigger, says):
    """Returns the message of a trigger that fulfils conditions."""
    exists, supported = says.get("eventExists"), says.get("isSupported", True)
    query = STATUS if supported else UNKNOWN
    supported = says.get("isCommandSupported", True)
    authority = 5 if says.get("isDefaultAuthorityGreater") else 60
    if not says.get("isCurrentAuthorityLess", True):
        authority = 40
    made = {
        "RequestControl": lambda: core.RequestControl(authority_code=authority),
        "SetAuthority": lambda: core.SetAuthority(authority_code=40),
        "CreateEvent": lambda: create(query),
        "UpdateEvent": lambda: update(0 if exists else 99, query),
        "CancelEvent": lambda: core.CancelEvent(request_id=9, event_id=0 if exists else 99),
        "CreateCommandEvent": lambda: command(SLOW if supported else UNKNOWN),
        "QueryIdentification": lambda: core.QueryIdentification(query_type=4),
        "QueryServices": query_services,
        "QueryServiceList": query_service_lists,
        "RegisterServices": lambda: register_services((ServiceIdentity("urn:x:Y", 1, 0),)),
        "QueryConfiguration": lambda: core.QueryConfiguration(query_type=2),
    }
    return made.get(trigger, getattr(core, trigger, None))()


def sender(each, leaf, says):
    """Returns who sends a message so that the conditions on it hold."""
    if "isControllingClient" in says:
        return "client" if says["isControllingClient"] else "rival"
    if "isIDStored" in says:
        return "bystander"
    is_kept = ".Controlled." in leaf and each.trigger != "RequestControl"
    return "client" if is_kept else "rival"


def named(message):
    """Returns what a message is called in the table."""
    code = getattr(message, "response_code", None)
    is_control = type(message).__name__ in ("ConfirmControl", "RejectControl")
    words = [type(message).__name__]
    if is_control:
        words.append(type(message).ResponseCode(code).name)
    return " ".join(words)


def outcome(world, each, situation, says):
    """Plays a transition; returns the innermost state afterwards, and what was sent."""
    settings = {
        "default_authority": 10,
        "control_timeout": 4 if each.trigger == "Timedout" else 0,
        "control_survives_emergency": True,
        "discovery_scope": Scope.SYSTEM if each.service == "Discovery" else Scope.COMPONENT,
    }
    stage = Stage(world, Row("", settings=settings), kind=Robot)
    for step in SITUATIONS[situation]:
        stage.do(step)
    leaf = CORE_STATES[situation]
    assert CORE_STATES[stage.component.status, stage.component.controller is not None] == leaf
    who = sender(each, leaf, says)
    if says.get("eventExists") or each.trigger in ("CommandExpired", "Timeout"):
        stage.do((who, EXISTING.get(each.trigger, create())))
    stage.heard()
    stage.do(OCCASIONS.get(each.trigger) or (who, asked(each.trigger, says)))
    sent = [named(message) for heard in stage.heard().values() for message in heard]
    return CORE_STATES[stage.component.status, stage.component.controller is not None], sent


EMERGENCY_ENDS = "in Standby somebody has to resume it: to stand still is what is safe"
FAILURE_STAYS = "what is broken must not work again when the emergency is cleared"
OF_IOP = "the IOP's definitions of v1.1: Shutdown in Ready alone, with code 1"
STRANGER = "the IOP's definitions of v1.1: there is no control to be released"
PASSES = "Init is passed through: the hook of the user has run when Reset is done"

OTHERWISE = {
    ("ReleaseControl", "NotControlled.NotAvailable.Failure"): ("-", "NOT_AVAILABLE", STRANGER),
    ("ReleaseControl", "NotControlled.NotAvailable.Shutdown"): ("-", "NOT_AVAILABLE", STRANGER),
    ("ReleaseControl", "NotControlled.NotAvailable.Emergency"): ("-", "NOT_AVAILABLE", STRANGER),
    ("Shutdown", "Controlled.Available.Standby"): ("-", "", OF_IOP),
    ("Shutdown", "Controlled.Available.Ready"): (
        "NotControlled.NotAvailable.Shutdown",
        "NOT_AVAILABLE",
        OF_IOP,
    ),
    ("Reset", "Controlled.Available.Standby"): (STANDBY, "CONTROL_RELEASED", PASSES),
    ("Reset", "Controlled.Available.Ready"): (STANDBY, "CONTROL_RELEASED", PASSES),
    ("ClearEmergency", "Controlled.NotAvailable.Emergency"): (
        "Controlled.Available.Standby",
        "",
        EMERGENCY_ENDS,
    ),
    ("Failure", "NotControlled.NotAvailable.Emergency"): (FAILURE, "", FAILURE_STAYS),
    ("Failure", "Controlled.NotAvailable.Emergency"): (FAILURE, "CONTROL_RELEASED", FAILURE_STAYS),
}
"""What the runtime does otherwise, by trigger and state: what is entered, the code of the
RejectControl that is sent, and why."""

UNPLAYED = {
    "EventError": "no occasion: nothing but its client, its timeout and Reset ends an event",
    "Initialized": "Init is passed through before anybody is heard; each row begins behind it",
}


def expected(each, situation):
    """Returns the state that is entered, and the names of what is sent."""
    leaf = CORE_STATES[situation].removeprefix(f"{READY}.")
    if (each.trigger, leaf) in OTHERWISE:
        target, code, _ = OTHERWISE[each.trigger, leaf]
        return leaf if target == "-" else target, [f"RejectControl {code}"] if code else []
    before = STANDBY if leaf.startswith("NotControlled") else "Controlled.Available.Ready"
    target = {"-": leaf, "before": before}.get(each.target, each.target)
    return target, [] if each.sent == "-" else each.sent.split(", ")


def played() -> Iterator[tuple[Transition, str, dict[str, bool]]]:
    """Yields each transition in each innermost state in which it holds, in each way to it."""
    for row in TABLE:
        guard = parse_guard(row.guard.strip("-"))
        for situation in SITUATIONS if row.trigger not in UNPLAYED else ():
            leaf = CORE_STATES[situation]
            for alternative in alternatives(guard) if guard else [()]:
                says = {condition.name: holds for condition, holds in alternative}
                if row.holds_in(leaf):
                    yield row, situation, says


def name(case: tuple[Transition, str, dict[str, bool]]) -> str:
    """Returns how a transition is called that is played."""
    row, situation, says = case
    return f"{row.trigger} {row.guard} {says} in {CORE_STATES[situation]}"


@for_each(("row", "situation", "says"), played(), ids=name, shards=2)
def test_the_runtime_does_what_the_machines_say(row, situation, says):
    target, sent = expected(row, situation)
    world = World()
    with world.loop:
        entered, heard = outcome(world, row, situation, says)
    # The first report of an event, or a further one, is what EventOccurred says.
    further = ["Event"] * heard.count("Event") if "Event" not in sent else []
    assert lies_in(entered, f"{READY}.{target}")
    assert sorted(heard) == sorted(sent + further)


def test_each_explanation_is_needed():
    """Of what the runtime does otherwise all is a difference from the table."""
    for (trigger, leaf), (target, code, _) in OTHERWISE.items():
        (each,) = (e for e in TABLE if e.trigger == trigger and e.holds_in(f"{READY}.{leaf}"))
        sent = [] if not code else [f"RejectControl {code}"]
        said = [] if each.sent == "-" else each.sent.split(", ")
        assert (each.target, said) != (target, sent)
    assert {row.trigger for row in TABLE} >= {*UNPLAYED}
