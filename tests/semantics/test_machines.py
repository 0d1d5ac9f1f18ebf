"""Machines along inheritance, paths of states, and what targets mean."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from jausml.language.metamodel.classes import jaus
from jausml.language.model import read_models
from jausml.language.semantics.jaus.inherited_machines import (
    DEEPEST,
    ENTERED_BY_SERVICES,
    canonical,
    core_events,
    core_machine,
    event_name,
    machines_of,
    too_deep,
)

ROOT = Path(__file__).resolve().parents[2]
LAMP = ROOT / "tests" / "generators" / "lamp.xmi"
WINCH = ROOT / "models" / "examples" / "winch" / "service.xmi"
READY = "Receiving.Ready.Controlled.Available.Ready"


@pytest.fixture(scope="module")
def lamps():
    result = read_models([LAMP], project_root=ROOT)
    services = {service.name: service for service in result.model.instances(jaus.Service)}
    return {machine.name: machine for machine in machines_of([services["Lamp"], services["Spot"]])}


@pytest.fixture(scope="module")
def winch():
    result = read_models([WINCH], project_root=ROOT)
    services = [s for s in result.model.instances(jaus.Service) if s.name == "Winch"]
    (machine,) = machines_of(services)
    return machine


def test_a_machine_of_an_heir_is_the_inherited_one(lamps):
    assert set(lamps) == {"LampFSM", "ReceiveFSM"}
    machine = lamps["LampFSM"]
    assert list(machine.nodes) == ["Off", "On", "On.Dim", "On.Bright", "Broken", "On.Turning"]
    # What the heir says of a state is tried before what it inherits.
    heir, inherited = machine.nodes["On"].elements
    assert [default.message.name for default in heir.defaults] == ["TurnSpot"]
    assert [default.event for default in inherited.defaults] == ["Burnt", "class"]


def test_heirs_that_do_not_inherit_each_other_have_machines_of_their_own():
    result = read_models([WINCH, LAMP], project_root=ROOT)
    found = {service.name: service for service in result.model.instances(jaus.Service)}
    machines = machines_of([found["Winch"], found["Lamp"], found["Spot"]])
    assert [machine.name for machine in machines] == ["ReceiveFSM", "LampFSM", "ReceiveFSM"]


def test_a_name_that_is_a_path_implies_what_encloses_it(winch):
    assert winch.nodes["Receiving.Ready.Controlled"].elements == []
    assert len(winch.nodes[READY].elements) == 1


def test_the_innermost_initial_state_is_entered(winch, lamps):
    assert winch.innermost(READY) == f"{READY}.Idle"
    assert winch.innermost("") == "Receiving.Ready.NotControlled.Available.Standby"
    assert winch.innermost("Receiving.Ready.Controlled") == (
        "Receiving.Ready.Controlled.Available.Standby"
    )
    assert lamps["LampFSM"].innermost("On") == "On.Dim"


@pytest.mark.parametrize(
    ("source", "target", "expected"),
    [
        (f"{READY}.Moving.PayingOut", "PayingIn", f"{READY}.Moving.PayingIn"),
        (f"{READY}.Moving.PayingOut", "Idle", f"{READY}.Idle"),
        (f"{READY}.Moving", "PayingIn", f"{READY}.Moving.PayingIn"),
        (f"{READY}.Idle", "Moving.PayingIn", f"{READY}.Moving.PayingIn"),
        (f"{READY}.Idle", "Standby", "Receiving.Ready.Controlled.Available.Standby"),
        (f"{READY}.Idle", READY, READY),
        (f"{READY}.Idle", "PayingIn", None),
        (f"{READY}.Idle", "Nowhere", None),
    ],
)
def test_a_target_is_sought_from_the_source_outwards(winch, source, target, expected):
    assert winch.resolve(source, target) == expected


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("Receiving.Ready.NotControlled.StateA", "Receiving.Ready.NotControlled"),
        ("Receiving.Ready.Controlled.StateB", "Receiving.Ready.Controlled"),
        ("Receiving.Ready.Controlled.StateB.Ready", READY),
        ("Receiving.Ready.Controlled.StateB.Ready.Busy", None),
        (
            "Receiving.Ready.NotControlled.StateA.Failure",
            "Receiving.Ready.NotControlled.NotAvailable.Failure",
        ),
        (READY, READY),
    ],
)
def test_groups_of_older_sets_are_left_out_of_paths(path, expected):
    assert canonical(path) == (expected or f"{READY}.Busy")


def test_core_states():
    core = core_machine(None)
    assert core.name == "Management"
    assert set(core.states) > set(core.leaves)
    assert len(core.leaves) == 8
    assert set(core.leaves) > ENTERED_BY_SERVICES
    assert core.leaf(f"{READY}.Moving.PayingOut") == READY
    assert core.leaf("Receiving.Ready") is None
    assert core_events() == {"Timedout", "Initialized", "Failure"}
    assert event_name("management.accessControl.Timedout") == "Timedout"
    assert event_name(None) == ""


def test_states_too_deep_are_found_by_branch_without_their_paths():
    """A name of thousands of parts once took minutes to refuse."""

    def state(name, *inner):
        return SimpleNamespace(name=name, states=list(inner))

    shallow = state(".".join("a" * DEEPEST))
    long = state(".".join("b" * 100_000), state("inside"))
    edge = state(".".join("c" * DEEPEST), state("first", state("further")), state("second"))
    machine = SimpleNamespace(states=[shallow, long, edge])
    assert [state.name for state in too_deep(machine)] == [long.name, "first", "second"]
