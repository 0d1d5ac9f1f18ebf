"""Products of state machines: held against the generated winch, and faults of models found."""

from pathlib import Path

import pytest

from jausml.generation.target import system_of
from jausml.language.model import read_models
from jausml.model_checking.checking import check_subject
from jausml.model_checking.runtime_machines import CommandConnection, ConnectionState
from jausml.model_checking.search import CONTROL, DEADLOCK, LATE_STOP, LIVELOCK, TIME, Bounds
from jausml.model_checking.systems import subjects_of

ROOT = Path(__file__).resolve().parents[2]
WINCH = ROOT / "models" / "examples" / "winch"
LAMP = ROOT / "tests" / "generators" / "lamp.xmi"
LIBRARY = "http://www.jausml.org/library/"


@pytest.mark.slow
def test_the_generated_winch_goes_the_same_ways(run_script):
    happened = run_script("walk_machine.py", model=WINCH / "winch.xmi")
    assert happened["difference"] is None
    assert happened["states"] >= 9
    assert happened["steps"] > 2000


def outcomes_of(path):
    """Returns the outcome of each subject of a model, by its name."""
    bounds = Bounds(100_000, lambda: False)
    subjects = subjects_of(system_of(read_models([path]).model))
    return {subject.name: check_subject(subject, bounds) for subject in subjects}


def found_in(path):
    """Returns the rules that each subject of a model breaks."""
    outcomes = outcomes_of(path).items()
    return {name: {example.rule for example in outcome.found} for name, outcome in outcomes}


def changed_winch(folder, file, old, new):
    """Returns the path of a winch with one change."""
    for name in ("service.xmi", "winch.xmi"):
        text = (WINCH / name).read_text(encoding="utf-8").replace("../../library/", LIBRARY)
        if name == file:
            assert text.count(old) == 1
            text = text.replace(old, new)
        (folder / name).write_text(text, encoding="utf-8")
    return folder / "winch.xmi"


@pytest.mark.parametrize(
    ("file", "old", "new", "rules"),
    [
        pytest.param("winch.xmi", 'controlTimeout="2"', 'controlTimeout="2"', set(), id="as it is"),
        pytest.param(
            "service.xmi",
            'message="Winch.LockBrake" guard="isControllingClient"',
            'message="Winch.LockBrake"',
            {CONTROL},
            id="a guard removed",
        ),
        pytest.param(
            "service.xmi",
            'guard="isControllingClient &amp;&amp; !(paysOut || paysIn)"',
            'guard="isControllingClient || !(paysOut || paysIn)"',
            {CONTROL},
            id="a guard turned",
        ),
        pytest.param(
            "winch.xmi",
            'controlTimeout="2"',
            'controlTimeout="0"',
            {LATE_STOP, LIVELOCK},
            id="a time-out left out",
        ),
    ],
)
def test_a_fault_of_a_machine_is_found(file, old, new, rules, tmp_path):
    assert found_in(changed_winch(tmp_path, file, old, new)) == {
        "winch: ReceiveFSM of Winch": rules
    }


def test_a_state_that_nothing_leaves_is_found(tmp_path):
    text = LAMP.read_text(encoding="utf-8")
    way_out = '<transitions message="ToggleLamp" kind="pop"/>'
    assert text.count(way_out) == 1
    (tmp_path / "lamp.xmi").write_text(text.replace(way_out, ""), encoding="utf-8")
    assert found_in(LAMP)["spot: LampFSM of Lamp"] == set()
    assert DEADLOCK in found_in(tmp_path / "lamp.xmi")["spot: LampFSM of Lamp"]


@pytest.mark.parametrize(
    ("old", "new", "omission"),
    [
        (
            'event="Burnt" guard="isOld"',
            f'event="Burnt" guard="{" &amp;&amp; ".join("abcdefgh")} &amp;&amp; !i"',
            "of the conditions in On.Dim only 8 at once were tried",
        ),
        (
            '<transitions message="ToggleLamp" kind="pop"/>',
            '<transitions message="ToggleLamp" kind="push" target="On"/>',
            "of the pushes before Broken only 4 were remembered",
        ),
    ],
    ids=["conditions", "pushes"],
)
def test_what_a_machine_is_too_large_for_is_no_pass(tmp_path, old, new, omission):
    text = LAMP.read_text(encoding="utf-8")
    assert text.count(old) == 1
    (tmp_path / "lamp.xmi").write_text(text.replace(old, new), encoding="utf-8")
    outcome = outcomes_of(tmp_path / "lamp.xmi")["spot: LampFSM of Lamp"]
    assert not outcome.is_complete
    assert omission in [example.message for example in outcome.found]


def test_all_ways_are_searched_in_which_a_lapse_of_control_may_be_taken(tmp_path):
    text = LAMP.read_text(encoding="utf-8")
    ways = """<defaults event="Timedout" guard="isOld" target="Off"/>
              <defaults event="Timedout" guard="isWorn" target="Broken"/>"""
    burnt = '<defaults event="Burnt" guard="isOld" target="Off"/>'
    assert text.count(burnt) == 1
    text = text.replace(burnt, ways).replace(
        'address="7.1.1"', 'address="7.1.1" controlTimeout="2"'
    )
    (tmp_path / "lamp.xmi").write_text(text, encoding="utf-8")
    subjects = subjects_of(system_of(read_models([tmp_path / "lamp.xmi"]).model))
    (product,) = (
        subject.product for subject in subjects if subject.name == "spot: LampFSM of Lamp"
    )
    states, lapses = [product.initial()], set()
    for state in states:
        for step, after in product.steps(state):
            if step is TIME and state.path == "On.Dim" and state.core.controller:
                lapses.add((after.path, bool(after.core.controller)))
            if after not in states and len(states) < 500:
                states.append(after)
    assert lapses == {("On.Dim", False), ("Off", False), ("Broken", False)}


REFINES_ACCESS_CONTROL = """<?xml version="1.0" encoding="UTF-8"?>
<xmi:XMI xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:jaus="http://www.jausml.org/jaus/1.0" xmlns:system="http://www.jausml.org/system/1.0">
  <jaus:ServiceSet name="farm">
    <services xmi:id="Baler" name="Baler" urn="urn:example:farm:Baler">
      <inherits href="http://www.jausml.org/library/jaus/core-1.1.xmi#AccessControl"/>
      <inputs xmi:id="Baler.SetBaling" name="SetBaling" code="0xD110" isCommand="true"/>
      <machines name="ReceiveFSM">
        <states name="Receiving.Ready.Controlled.Available">
          <states name="Idle" initial="true">
            <transitions message="Baler.SetBaling" guard="isControllingClient"
                target="Receiving.Ready.Controlled.{target}"/>
          </states>
          <states name="Baling"/>
        </states>
        <states name="Receiving.Ready.Controlled.NotAvailable"><states name="Baling"/></states>
      </machines>
    </services>
  </jaus:ServiceSet>
  <system:System name="farm">
    <components name="baler" address="1.1.1" controlTimeout="2" provides="Baler"/>
  </system:System>
</xmi:XMI>
"""


@pytest.mark.parametrize(
    ("target", "rules"),
    [("Available.Baling", set()), ("NotAvailable.Baling", {DEADLOCK, LIVELOCK, LATE_STOP})],
)
def test_control_lapses_where_it_is_available_alone(tmp_path, target, rules):
    """A machine that has made control unavailable keeps a client that is lost (AS5710)."""
    path = tmp_path / "farm.xmi"
    path.write_text(REFINES_ACCESS_CONTROL.format(target=target), encoding="utf-8")
    (found,) = found_in(path).values()
    assert found == rules


def test_a_connection_that_was_stopped_counts_no_silence():
    """States of the same future are one, or the search has more of them."""
    connection = CommandConnection("ANY", silence=2)
    moving = connection.take(ConnectionState())
    silent = connection.tick(connection.tick(moving))
    assert silent == connection.stop(moving) == ConnectionState(is_stopped=True, silent_in=0)


JAMS = """<?xml version="1.0" encoding="UTF-8"?>
<xmi:XMI xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:jaus="http://www.jausml.org/jaus/1.0" xmlns:system="http://www.jausml.org/system/1.0">
  <jaus:ServiceSet name="farm">
    <services xmi:id="Baler" name="Baler" urn="urn:example:farm:Baler">
      <inherits href="http://www.jausml.org/library/jaus/core-1.1.xmi#Management"/>
      <events name="Jammed"/>
      <machines name="BalerFSM">
        <states name="On">
          <transitions event="Jammed" target="Held"/>
          <states name="Baling" initial="true">
            <states name="Turning" initial="true"/>
            <states name="Held"/>
          </states>
          <states name="Held"/>
        </states>
      </machines>
    </services>
  </jaus:ServiceSet>
  <system:System name="farm">
    <components name="baler" address="1.1.1" controlTimeout="2" provides="Baler"/>
  </system:System>
</xmi:XMI>
"""


def test_a_target_is_looked_for_from_the_state_of_its_transition(tmp_path):
    """As generated code does, and not from the state in which the machine is."""
    path = tmp_path / "farm.xmi"
    path.write_text(JAMS, encoding="utf-8")
    (subject,) = subjects_of(system_of(read_models([path]).model))
    start = subject.product.initial()
    assert start.path == "On.Baling.Turning"
    after = {after.path for step, after in subject.product.steps(start) if "Jammed" in step.what}
    assert after == {"On.Held"}
