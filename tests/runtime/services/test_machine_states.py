"""MachineStates: where machines are and for how long, to the millisecond of a turned clock."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lossy_network import CORE, VEHICLE, LossyNetwork

from jausml.live.messages import load_catalogue
from jausml.runtime import ServiceIdentity
from jausml.runtime.component.modelled import ModelledComponent
from jausml.runtime.component.state_machine import On, State
from jausml.runtime.messages import CreateEvent, Event, RequestControl, Reset
from jausml.runtime.messages.machine_states import (
    MACHINE_STATES,
    QueryMachineStates,
    ReportMachineStates,
)
from jausml.runtime.services import machine_states
from jausml.runtime.wire.message import DecodeError

from .conftest import CORE_SERVICES

URN = "urn:test:Door"
SERVICES = (*CORE_SERVICES, ServiceIdentity(MACHINE_STATES, 1, 0))
RELEASED = "Receiving.Ready.NotControlled.Available.Standby"
CONTROLLED = "Receiving.Ready.Controlled.Available.Standby"
BYTES = bytes.fromhex(
    "20fa"  # code
    "01"  # machines
    "0d75726e3a746573743a446f6f72"  # urn:test:Door
    "04446f6f72"  # Door
    "044f70656e"  # Open
    "dc05000000000000"  # 1500 ms
    "02"  # states
    "06436c6f736564"  # Closed
    "01000000"
    "c409000000000000"  # 2500 ms
    "044f70656e"
    "02000000"
    "d007000000000000"  # 2000 ms
)


class Door(ModelledComponent):
    """Opens, closes, and has a machine that follows the core services."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        states = (
            State("Open", initial=True, transitions=(On("Turn", target="Closed"),)),
            State("Closed", transitions=(On("Turn", target="Open"),)),
        )
        self.door = self.add_machine("Door", states, service=URN)


class Guarded(Door):
    """Also has a machine of the name that extends the core."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.add_machine("ReceiveFSM", (), extends="Management", service=URN)


@pytest.fixture
def client(world):
    return world.probe("2.1.1")


def started(world, kind=Door, services=SERVICES):
    return world.started("1.1.1", kind=kind, services=services)


def told(client, component):
    (report,) = client.ask(QueryMachineStates(), component)
    return report


def times(machine):
    return [(record.state, record.entries, record.milliseconds) for record in machine.time_list]


def test_the_report_has_these_bytes(world, client):
    door = started(world)
    world.run(0.5)
    door.raise_event("Turn")
    world.run(2.5)
    door.raise_event("Turn")
    world.run(1.5)
    assert told(client, door).encode() == BYTES
    assert QueryMachineStates().encode() == bytes.fromhex("20ea")


def test_the_library_says_the_same():
    catalogue = load_catalogue()
    message = catalogue.decode(BYTES)
    (machine,) = message.fields["MachineList"]
    assert machine["MachineRec"]["State"] == "Open"
    assert catalogue.encode({"message": "ReportMachineStates", "fields": message.fields}) == BYTES
    assert ReportMachineStates.decode(BYTES).encode() == BYTES


def test_time_in_states_is_exact_and_a_reset_is_an_entry(world, client):
    door = started(world, Guarded)
    world.run(3.25)
    client.ask(RequestControl(authority_code=200), door)
    world.run(1.125)
    machines = told(client, door).machine_list
    assert [machine.machine_rec.machine for machine in machines] == ["Door", "ReceiveFSM"]
    guarded = machines[1]
    assert (guarded.machine_rec.state, guarded.machine_rec.milliseconds) == (CONTROLLED, 1125)
    assert (RELEASED, 1, 3250) in times(guarded)
    client.ask(Reset(), door)
    world.run(0.5)
    (opened,) = times(told(client, door).machine_list[0])
    assert opened == ("Open", 2, 4875)


def test_who_does_not_list_it_answers_nothing_and_keeps_no_times(world, client):
    door = started(world, services=CORE_SERVICES)
    assert client.ask(QueryMachineStates(), door) == []
    assert door.door._entered is None


def test_a_component_without_machines_has_an_empty_report(world, client):
    assert told(client, world_component(world)) == ReportMachineStates([])


def world_component(world):
    return world.started("1.1.1", services=SERVICES)


def test_an_event_tells_each_change(world, client):
    door = started(world)
    create = CreateEvent(1, CreateEvent.EventType.EVERY_CHANGE, 0.0, QueryMachineStates().encode())
    client.ask(create, door)
    door.raise_event("Turn")
    door.raise_event("Turn")
    events = client.take(Event)
    states = [
        ReportMachineStates.decode(event.report_message).machine_list[0].machine_rec.state
        for event in events
    ]
    assert states == ["Closed", "Open"]


def test_a_count_of_entries_stays_at_its_end(world, client, monkeypatch):
    monkeypatch.setattr(machine_states, "MAX_ENTRIES", 3)
    door = started(world)
    for _ in range(10):
        door.raise_event("Turn")
    assert [time[1] for time in times(told(client, door).machine_list[0])] == [3, 3]


class Many(ModelledComponent):
    """Has more states than a report tells, with names that no JAUS string carries."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        names = [f"状態{number}" + "x" * 300 for number in range(400)]
        states = [
            State(name, initial=not number, transitions=(On("Next", target=after),))
            for number, (name, after) in enumerate(zip(names, names[1:] + names[:1], strict=True))
        ]
        for name in ("One", "Two"):
            self.add_machine(name, states, service=URN)


def test_a_report_is_bounded_and_tells_the_longest_stays(world, client):
    many = started(world, Many)
    for number in range(399):
        world.run(0.01 * (number == 7))
        many.raise_event("Next")
    one, two = told(client, many).machine_list
    assert len(one.time_list) == len(two.time_list) == 127
    assert one.time_list[0].state == "??7" + "x" * 252
    assert one.time_list[0].milliseconds == 10
    assert one.machine_rec.state.startswith("??399x")


@given(st.binary(max_size=80), st.integers(0, len(BYTES)))
def test_hostile_reports_are_refused_or_read(noise, cut):
    for payload in (BYTES[:cut], BYTES[:cut] + noise, BYTES + noise):
        try:
            report = ReportMachineStates.decode(payload)
        except DecodeError:
            continue
        assert report.encode() == payload


class Doors(LossyNetwork):
    """The vehicle is a door."""

    def _vehicle(self):
        services = (*CORE, ServiceIdentity(MACHINE_STATES, 1, 0))
        settings = self._settings
        return Door(self._transports[0], VEHICLE, name="door", services=services, settings=settings)


@pytest.mark.ports
@pytest.mark.parametrize("seed", range(3))
def test_a_client_learns_states_and_times_though_a_fifth_is_lost(seed):
    found = []
    with Doors(0.2, seed) as network:
        network.operator.subscribe(
            VEHICLE,
            QueryMachineStates(),
            ReportMachineStates,
            lambda report, _: found.append(report.machine_list[0]),
            rate=2.0,
        )
        network.run(10.0)
        network.vehicle.raise_event("Turn")
        network.run(10.0)
    assert {record.machine_rec.state for record in found} == {"Open", "Closed"}
    assert ("Open", 1, 10_000) in times(found[-1])
