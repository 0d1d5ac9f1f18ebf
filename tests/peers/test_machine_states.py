"""Where machines are, as observers learn it: of a generated winch, and of who tells nonsense."""

import json
import subprocess
import sys
import time
from contextlib import contextmanager

import pytest
from click.testing import CliRunner
from ports import free_port
from running_winch import ADDRESS, READY, running_winch, telling_winch

import jausml
from jausml.cli import main
from jausml.live.peers.operator import running_operator
from jausml.live.systems import monitoring
from jausml.live.systems.machines import MOST_MACHINES
from jausml.live.systems.monitoring import Monitor, polling
from jausml.live.systems.state import ComponentState, Level, SystemState
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages.events import CancelEvent
from jausml.runtime.messages.machine_states import (
    MACHINE_STATES,
    QueryMachineStates,
    ReportMachineStates,
)

pytestmark = pytest.mark.ports

PATIENCE = 40.0


@pytest.fixture(scope="module")
def winch(tmp_path_factory):
    """The port and the model of a winch that runs."""
    folder = tmp_path_factory.mktemp("winch")
    model, port = telling_winch(folder), free_port()
    with running_winch(model, port, folder / "winch.log"):
        yield port, model


def wait_for(condition):
    end = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert time.monotonic() < end
        time.sleep(0.02)
    return found


@pytest.mark.slow
def test_a_generated_winch_is_seen_to_move(winch):
    port, model = winch
    with jausml.Component("200.1.1", port=port, models=str(model), timeout=PATIENCE) as operator:

        def machine():
            (found,) = operator.query(ADDRESS, "MachineStates")["MachineList"]
            return found["MachineRec"]

        assert machine()["Service"] == "urn:jausml:examples:Winch"
        with operator.control(ADDRESS, authority=210):
            wait_for(lambda: machine()["State"] == f"{READY}.Idle")
            operator.command(ADDRESS, "SetWinchCommand", {"RopeSpeed": 0.1})
            wait_for(lambda: machine()["State"] == f"{READY}.Moving.PayingOut")
            arguments = ("top", "--once", "--duration", "4", "--port", str(port))
            told = CliRunner().invoke(main, [*arguments, "--json"])
            table = CliRunner().invoke(main, [*arguments])
    (component,) = [e for e in json.loads(told.stdout)["components"] if e["id"] == ADDRESS]
    (told,) = component["machines"]
    assert told["state"] == f"{READY}.Moving.PayingOut"
    assert told["seconds"] > 0
    assert {state["state"]: state["entries"] for state in told["times"]}[told["state"]] == 1
    (line,) = [row for row in table.stdout.splitlines() if "ReceiveFSM" in row]
    assert line.split()[:4] == [ADDRESS, "Winch", "ReceiveFSM", "Moving.PayingOut"]
    assert "NotControlled.Available.Standby" in line


def observed(network, catalogue, condition):
    """Observes until a condition of the machines of the target holds, and returns them."""
    monitor = Monitor(SystemState())

    def machines():
        found = monitor.state().components.get("100.1.1")
        return condition(found) if found is not None else None

    with running_operator(network, catalogue) as operator, polling(monitor, operator):
        return wait_for(machines)


def nonsense():
    """A report of unknown states, of more machines than are kept."""
    rec = ReportMachineStates.MachineRec("urn:\x1b[2J", "\x07", "No.Such\x1b[2J", 2**64 - 1)
    time_rec = ReportMachineStates.TimeRec("Other", 2**32 - 1, 2**64 - 1)
    return ReportMachineStates([ReportMachineStates.MachineSeq(rec, [time_rec] * 255)] * 255)


def test_nonsense_is_kept_as_data_and_bounded(component, network, catalogue):
    component(telling=lambda *_: nonsense())
    machines = observed(network, catalogue, lambda found: found.machines)
    assert len(machines) == MOST_MACHINES
    assert machines[0].state == "No.Such\x1b[2J"


def test_a_report_that_cannot_be_read_says_nothing(component, network, catalogue):
    asked = []

    def report(_query, _sender):
        asked.append(True)
        return nonsense().encode()[:-1]

    component(telling=report)
    found = observed(network, catalogue, lambda found: len(asked) > 1 and found)
    assert found.machines == ()
    assert found.state == "STANDBY"


def test_changes_come_by_the_event_and_times_go_on_meanwhile(component, network, catalogue):
    states, asked, rounds = ["Idle"], [], set()

    def report(_query, _sender):
        rec = ReportMachineStates.MachineRec("urn:winch", "Drum", states[-1], 5000)
        time_rec = ReportMachineStates.TimeRec(states[-1], 1, 5000)
        return ReportMachineStates([ReportMachineStates.MachineSeq(rec, [time_rec])])

    target = component(telling=report)
    target.on_payload(QueryMachineStates, lambda payload, _: asked.append(payload))

    def condition(found):
        rounds.add(found.round_trip)
        machine = next(iter(found.present_machines), None)
        if machine is None:
            return None
        if states[-1] == "Idle" and machine.seconds > 8 and machine.times[0].seconds > 8:
            states.append("Moving")
            target.report_changed(ReportMachineStates)
        return machine if machine.state == "Moving" else None

    assert observed(network, catalogue, condition).seconds < 8
    assert len(rounds) > 4
    assert len(asked) <= 2  # before its event was confirmed


def test_who_stops_telling_is_not_shown_where_it_was(component, network, catalogue, monkeypatch):
    monkeypatch.setattr(monitoring, "_SELDOM", 3)
    monkeypatch.setattr(monitoring, "ROUND", 0.25)
    answers, seen = [nonsense()], []

    def report(_query, _sender):
        return answers.pop() if answers else None

    def condition(found):
        seen.append(bool(found.machines))
        return any(seen) and not seen[-1] and found

    component(telling=report)
    assert observed(network, catalogue, condition).state == "STANDBY"


def test_who_does_not_provide_it_is_never_asked(component, network, catalogue):
    target, asked, rounds = component(), [], []
    target.on_payload(QueryMachineStates, lambda payload, _: asked.append(payload))

    def condition(found):
        rounds.append(found.round_trip)
        return found.services and len(set(rounds)) > 3

    assert observed(network, catalogue, condition)
    assert asked == []


def test_who_provides_it_no_more_is_not_followed_any_more(
    component, network, catalogue, monkeypatch
):
    monkeypatch.setattr(monitoring, "ROUND", 0.25)
    monkeypatch.setattr(monitoring, "DISCOVERY", 2)
    cancelled = []
    target = component(telling=lambda *_: nonsense())
    target.on_payload(CancelEvent, lambda payload, _: cancelled.append(payload))

    def condition(found):
        if found.machines:
            remaining = [service for service in target.services if service.urn != MACHINE_STATES]
            target.services = tuple(remaining)
        return cancelled

    assert observed(network, catalogue, condition)


ROVER = """
import sys, time
import jausml
from jausml.runtime import ComponentSettings, JausComponent, ServiceIdentity
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.component.process import running_transport

with running_transport(TransportSettings(port=int(sys.argv[1]))) as transport:
    component = JausComponent(
        transport, JausAddress(100, 1, 7), name=sys.argv[2],
        services=[ServiceIdentity(each, 1, 1) for each in sys.argv[3:]],
        settings=ComponentSettings(register_services=False),
    )
    component.start()
    time.sleep(600)
"""
CORE = [f"urn:jaus:jss:core:{service}" for service in ("Transport", "Events", "Management")]
DISCOVERY = "urn:jaus:jss:core:Discovery"


@contextmanager
def rover(port, name, services):
    arguments = [sys.executable, "-c", ROVER, str(port), name, *services]
    process = subprocess.Popen(arguments)
    try:
        yield
    finally:
        process.kill()
        process.wait()


@pytest.mark.slow
@pytest.mark.parametrize("answers", [True, False])
def test_what_one_provided_that_was_replaced_is_forgotten(
    network, catalogue, free_port, answers, monkeypatch
):
    """The other one, which answers no Discovery or has another name, provides less."""
    monkeypatch.setattr(monitoring, "ROUND", 0.25)  # or it takes twenty to find it gone and back
    monitor, target = Monitor(SystemState()), JausAddress(100, 1, 7)

    def seen(condition):
        found = monitor.state().components.get(str(target))
        return found if found is not None and condition(found) else None

    with running_operator(network, catalogue) as operator, polling(monitor, operator):
        with rover(free_port, "first", [*CORE, DISCOVERY, "urn:jaus:jss:mobility:X"]):
            wait_for(
                lambda: seen(lambda component: any("mobility" in e for e in component.services))
            )
        wait_for(lambda: seen(lambda component: component.is_gone))
        with rover(free_port, "second", [*CORE, DISCOVERY] if answers else CORE):
            found = wait_for(lambda: seen(lambda component: component.level is Level.OK))
            assert not any("mobility" in service for service in found.services)
            assert not any("mobility" in service.urn for service in operator.services(target))
            if answers:
                wait_for(lambda: seen(lambda component: component.services))


def test_who_speaks_at_its_start_is_asked_what_it_provides_at_once(
    network, catalogue, free_port, monkeypatch
):
    monkeypatch.setattr(monitoring, "DISCOVERY", 10**6)  # nobody but those of the start
    declared = ComponentState("100.1.7", is_declared=True)
    monitor = Monitor(SystemState(components={"100.1.7": declared}))

    def services():
        return monitor.state().components["100.1.7"].services

    provided = [*CORE, DISCOVERY, "urn:jaus:jss:mobility:X"]
    with (
        running_operator(network, catalogue) as operator,
        polling(monitor, operator),
        rover(free_port, "rover", provided),
    ):
        assert any("mobility" in service for service in wait_for(services))


@pytest.mark.slow
def test_who_was_replaced_before_it_was_missed_is_another_one(network, catalogue, free_port):
    """The other one has the same name and answers no Discovery; only its packets tell of it."""
    monitor, target = Monitor(SystemState()), JausAddress(100, 1, 7)

    def seen(condition):
        found = monitor.state().components.get(str(target))
        return found if found is not None and condition(found) else None

    with running_operator(network, catalogue) as operator, polling(monitor, operator):
        with rover(free_port, "rover", [*CORE, DISCOVERY, "urn:jaus:jss:mobility:X"]):
            wait_for(
                lambda: seen(lambda component: any("mobility" in e for e in component.services))
            )
            heard = operator.lives()[target]
        with rover(free_port, "rover", CORE):
            found = wait_for(lambda: seen(lambda component: not component.services))
            assert not found.is_gone
            assert operator.lives()[target] == heard + 1
            assert not operator.services(target)
