"""Machines that are stepped by hand, and the tests that are made of paths."""

import os
import sys
from pathlib import Path
from random import Random

import pytest
from generated import WITHOUT_PLUGINS
from scripts import ran
from sweeps import sweep

from jausml.authoring.editing.project import Project
from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.handlers.stepping import METHODS
from jausml.language.metamodel.classes import jaus
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.model_checking.stepping import (
    Chosen,
    SteppingError,
    choices,
    stepped_machine,
    stepped_test,
    walked,
)
from jausml.model_checking.systems import machine_subjects

ROOT = Path(__file__).resolve().parents[2]
WINCH = ROOT / "models" / "examples" / "winch" / "winch.xmi"
LAMP = ROOT / "tests" / "generators" / "lamp.xmi"
READY = (Chosen("a client", "RequestControl"), Chosen("a client", "Resume"))
STATE = "Receiving.Ready.Controlled.Available.Ready"


def stepped(path, name="ReceiveFSM"):
    """Returns a model and its machine of a name."""
    model = read_models([path], notations=NOTATIONS).model
    machines = model.instances(jaus.StateMachine, library=False)
    return model, stepped_machine(
        model, next(machine for machine in machines if machine.name == name)
    )


@pytest.fixture(scope="module")
def winch():
    return stepped(WINCH)


def ends(machine, *steps):
    """Returns the state to which a path leads."""
    return walked(machine.product, steps)[-1].after.path


def passed_in(path, folder, python_path):
    """Returns whether the tests of a folder pass beside packages, and what pytest says."""
    done = ran(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", path],
        cwd=folder,
        env={**os.environ, **WITHOUT_PLUGINS, "PYTHONPATH": python_path, "PYTEST_ADDOPTS": ""},
        timeout=200,
    )
    return done.returncode == 0, done.stdout


def random_path(machine, seed, length=30):
    """Returns steps of which most have an effect."""
    random, path = Random(seed), []
    own = machine.product.own_conditions()
    state = machine.product.initial()
    for _ in range(length):
        said = {condition: random.random() < 0.5 for condition in own}
        offered = list(choices(machine.product, state, said))
        final = ("Shutdown", "fails", "Reset", "SetEmergency")
        likely = [e for e in offered if not e.why_not and e.what not in final]
        step = random.choice(likely if random.random() < 0.9 else offered)
        path.append(Chosen(step.actor, step.what, said))
        state = step.after
    return path


def test_conditions_are_asked_and_those_of_the_core_computed(winch):
    _, machine = winch
    assert machine.product.own_conditions() == ["leadsBeyondRope", "paysOut", "paysIn"]
    out = Chosen("a client", "SetWinchCommand", {"paysOut": True})
    assert ends(machine, *READY, out) == f"{STATE}.Moving.PayingOut"
    assert ends(machine, *READY, Chosen("a client", "SetWinchCommand")) == f"{STATE}.Idle"
    other = Chosen("an operator of more authority", "SetWinchCommand", {"paysOut": True})
    assert ends(machine, *READY, other) == f"{STATE}.Idle"


def test_what_has_no_effect_says_why(winch):
    _, machine = winch
    state = walked(machine.product, READY)[-1].after
    why = {(e.actor, e.what): e.why_not for e in choices(machine.product, state, {})}
    assert why["winch", "EndStop"] == "no transition takes it in Idle"
    assert why["winch", "LoadLost"] == ""
    assert why["a client", "Resume"] == "it changes nothing in READY, controlled by a client"
    assert why["time", "passes"] == ""


def test_control_lapses_as_time_passes(winch):
    _, machine = winch
    assert machine.tick == 2.0
    end = "Receiving.Ready.NotControlled.Available.Standby"
    assert ends(machine, *READY, Chosen("time", "passes")) == end


def test_nobody_has_more_than_the_greatest_authority(winch, monkeypatch):
    model, _ = winch
    [component] = (e for e in model.instances(jaus.Component, library=False) if e.provides)
    monkeypatch.setattr(component, "defaultAuthority", 255)
    (subject,) = machine_subjects(component)
    assert subject.product.services.authorities == {
        "a client": 255,
        "an operator of more authority": 255,
    }


MACHINE = """
service_set s { service Own { urn: "urn:example:Own"  inherits: Management
    inputs: new message_def Turn { code: 0xD101 }
    internal_event Initialized  internal_event Failure
    state_machine OwnFSM {
        state A { initial: true  transitions: { event: Initialized  target: B } }
        state B { transitions: { message: Turn  target: C } }
        state C { transitions: { event: Failure  guard: isHot  target: A } }
    }
} }
system of { component own { address: 7.1.1  provides: Own } }
"""


def test_what_the_core_does_reaches_a_machine_beside_it(tmp_path, path_of):
    path = tmp_path / "own.ros2jaus"
    path.write_text(MACHINE, encoding="utf-8")
    read, machine = stepped(path, "OwnFSM")
    turn, reset = Chosen("a client", "Turn"), Chosen("a client", "Reset")
    assert machine.product.initial().path == "B"
    assert ends(machine, *READY, turn) == "C"
    assert ends(machine, *READY, turn, reset) == "B"
    assert ends(machine, turn, Chosen("own", "fails")) == "C"
    fails = (turn, Chosen("own", "fails", {"isHot": True}))
    assert ends(machine, *fails) == "A"
    (tmp_path / "tests").mkdir()
    for number, steps in enumerate(((*READY, turn, reset), fails)):
        text = stepped_test(read, machine, steps)
        (tmp_path / "tests" / f"test_path_{number}.py").write_text(text, encoding="utf-8")
    has_passed, said = passed_in("tests", tmp_path, path_of(path))
    assert has_passed, said


def test_a_step_that_is_gone_is_named(winch):
    _, machine = winch
    with pytest.raises(SteppingError, match=r"step 3: winch has no RopeCut any more"):
        walked(machine.product, [*READY, Chosen("winch", "RopeCut")])


@pytest.mark.parametrize(
    ("model", "name"),
    sweep([(WINCH, "ReceiveFSM"), (LAMP, "ReceiveFSM"), (LAMP, "LampFSM")], every=3),
)
def test_the_generated_component_goes_random_paths(model, name, path_of, tmp_path):
    read, machine = stepped(model, name)
    states = set()
    for seed in range(12):
        path = random_path(machine, seed)
        states.update(choice.after.path for choice in walked(machine.product, path))
        text = stepped_test(read, machine, path)
        (tmp_path / f"test_path_{seed}.py").write_text(text, encoding="utf-8")
    assert len(states) >= 4
    has_passed, said = passed_in(".", tmp_path, path_of(model))
    assert has_passed, said


def test_a_path_of_another_machine_fails(winch, path_of, tmp_path):
    read, machine = winch
    out = Chosen("a client", "SetWinchCommand", {"paysOut": True})
    text = stepped_test(read, machine, [*READY, out])
    changed = text.replace("PayingOut", "PayingIn")
    assert changed != text
    (tmp_path / "test_changed.py").write_text(changed, encoding="utf-8")
    has_passed, said = passed_in("test_changed.py", tmp_path, path_of(WINCH))
    assert not has_passed
    assert "PayingOut" in said


def test_a_service_without_component_is_stepped_but_not_tested(tmp_path):
    text = LAMP.read_text(encoding="utf-8")
    file = tmp_path / "lamp.xmi"
    file.write_text(f"{text.split('<system')[0]}</xmi:XMI>", encoding="utf-8")
    model, machine = stepped(file, "LampFSM")
    toggled = Chosen("a client", "ToggleLamp")
    assert ends(machine, *READY, toggled) == "On.Dim"
    with pytest.raises(SteppingError, match="no component of the model has this machine"):
        stepped_test(model, machine, [*READY, toggled])


def test_a_machine_beside_one_that_leads_the_core_is_not_tested():
    model, machine = stepped(LAMP, "LampFSM")
    assert machine.beside == ("ReceiveFSM of Spot",)
    with pytest.raises(SteppingError, match="ReceiveFSM of Spot may act meanwhile"):
        stepped_test(model, machine, READY)


def test_a_machine_with_an_unreadable_guard_is_not_stepped(tmp_path):
    text = (WINCH.parent / "service.xmi").read_text("utf-8")
    (tmp_path / "service.xmi").write_text(text.replace("paysOut", "paysOut !"))
    context = StudioContext(Project(tmp_path))
    with pytest.raises(AnswerError, match="a guard cannot be read"):
        METHODS["step"](context, "service.xmi", "machine:ReceiveFSM", (), {})
