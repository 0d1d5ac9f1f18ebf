"""State machines alone: which transition is taken, and what it does in which order (AS5684)."""

import pytest

from jausml.runtime.base.address import JausAddress
from jausml.runtime.component.state_machine import (
    REMEMBERED_STATES,
    Kind,
    On,
    State,
    StateMachine,
    all_of,
    any_of,
    negation,
)
from jausml.runtime.messages import QueryTime, Resume, Standby

SENDER = JausAddress(1, 1, 1)
WORK = "Receiving.Ready.Controlled.Available.Ready"
REST = "Receiving.Ready.Controlled.Available.Standby"


class Recorder:
    """A host that notes what is done, and whose core state tests set."""

    def __init__(self):
        self.done = []
        self.core = REST
        self.may_enter = True

    def run_condition(self, condition, arguments):
        return condition(*arguments)

    def run_action(self, action, arguments):
        action(*arguments)

    def core_state(self, _of):
        return self.core

    def request_core_state(self, path, _of):
        self.done.append(f"request {path}")
        if self.may_enter:
            self.core = REST if path.startswith(REST) else WORK

    def ignored(self, reason, _detail):
        self.done.append(reason)

    def note(self, text):
        return lambda *_: self.done.append(text)

    def take(self):
        done, self.done = self.done, []
        return done


@pytest.fixture
def host():
    return Recorder()


def state(host, path, *transitions, defaults=(), initial=False):
    return State(
        path,
        initial=initial,
        entry=(host.note(f"+{path}"),),
        exit=(host.note(f"-{path}"),),
        transitions=transitions,
        defaults=tuple(defaults),
    )


def started(host, *states, extends=""):
    machine = StateMachine("test", states, host, extends=extends)
    machine.start()
    return machine


def done_at(machine, host, event="e"):
    """What is done when an event comes."""
    host.take()
    machine.raise_event(event)
    return host.take()


def test_start_enters_the_initial_states_from_outside_in(host):
    machine = started(
        host, state(host, "A"), state(host, "B", initial=True), state(host, "B.C", initial=True)
    )
    assert machine.state == "B.C"
    assert host.take() == ["+B", "+B.C"]
    assert machine.states == ("A", "B", "B.C")


def test_nothing_is_taken_before_the_start(host):
    machine = StateMachine("test", (state(host, "A", On("e"), initial=True),), host)
    assert not machine.raise_event("e")
    assert machine.state == ""


def test_exit_then_actions_then_entry_up_to_the_common_state(host):
    machine = started(
        host,
        state(host, "A", initial=True),
        state(host, "A.B", initial=True),
        state(host, "A.B.C", On("e", do=(host.note("act"),), target="A.D"), initial=True),
        state(host, "A.D"),
        state(host, "A.D.E", initial=True),
    )
    host.take()
    assert machine.raise_event("e")
    assert host.take() == ["-A.B.C", "-A.B", "act", "+A.D", "+A.D.E"]
    assert machine.state == "A.D.E"


def test_a_target_that_encloses_the_state_is_left_and_entered(host):
    machine = started(
        host,
        state(host, "A", initial=True),
        state(host, "A.B", initial=True),
        state(host, "A.C", On("e", target="A")),
    )
    machine._enter("A.B")
    machine._leave("A")
    machine._enter("A.C")
    assert done_at(machine, host) == ["-A.C", "-A", "+A", "+A.B"]


def test_simple_without_target_only_acts(host):
    machine = started(
        host,
        state(host, "A", On("e", do=(host.note("act"),)), initial=True),
        state(host, "A.B", initial=True),
        state(host, "A.C"),
    )
    assert done_at(machine, host) == ["act"]
    assert machine.state == "A.B"


def test_simple_to_the_present_state_enters_it_again(host):
    machine = started(
        host, state(host, "A", On("e", do=(host.note("act"),), target="A"), initial=True)
    )
    assert done_at(machine, host) == ["-A", "act", "+A"]


def test_actions_find_the_state_from_which_the_transition_goes(host):
    found = []

    def look(*_):
        found.append(machine.state)

    machine = StateMachine(
        "test",
        [
            State(
                "A",
                initial=True,
                transitions=(On("e", target="A.B", do=(look,)), On("go", target="D.E", do=(look,))),
            ),
            State("A.B", initial=True, entry=(look,), exit=(look,)),
            State("D", entry=(look,), exit=(look,)),
            State("D.E", entry=(look,), exit=(look,)),
        ],
        host,
    )
    machine.start()
    machine.raise_event("e")
    assert found == ["A.B", "A.B", "A.B", "A.B"]
    machine.raise_event("go")
    assert found[4:] == ["A.B", "A.B", "D", "D.E"]


def test_the_first_transition_whose_guard_holds_is_taken(host):
    answers = {"first": False, "second": True}
    machine = started(
        host,
        state(
            host,
            "A",
            On("e", when=lambda: answers["first"], do=(host.note("1"),), kind=Kind.INTERNAL),
            On("e", when=lambda: answers["second"], do=(host.note("2"),), kind=Kind.INTERNAL),
            On("e", do=(host.note("3"),), kind=Kind.INTERNAL),
            initial=True,
        ),
    )
    host.take()
    machine.raise_event("e")
    answers["first"] = True
    machine.raise_event("e")
    answers.update(first=False, second=False)
    machine.raise_event("e")
    assert host.take() == ["2", "1", "3"]


def test_inside_before_outside_defaults_before_transitions_anything_else_last(host):
    open_guards = {"own", "own default", "default", "outer", "any own", "any outer"}

    def on(trigger, name):
        return On(
            trigger, when=lambda *_: name in open_guards, do=(host.note(name),), kind=Kind.INTERNAL
        )

    machine = started(
        host,
        state(
            host, "A", on("e", "outer"), on(None, "any outer"), defaults=[on("e", "default")],
            initial=True,
        ),
        state(
            host, "A.B", on(None, "any own"), on("e", "own"), defaults=[on("e", "own default")],
            initial=True,
        ),
    )  # fmt: skip
    host.take()
    expected = ["own", "own default", "default", "outer", "any own", "any outer"]
    for name in expected:
        assert machine.raise_event("e")
        open_guards.discard(name)
    assert not machine.raise_event("e")
    assert host.take() == expected


def test_push_remembers_and_pop_goes_back_in_order(host):
    machine = started(
        host,
        state(host, "A", On("push", target="B", kind=Kind.PUSH), initial=True),
        state(host, "B", On("push", target="C", kind=Kind.PUSH), On("pop", kind=Kind.POP)),
        state(host, "C", On("pop", kind=Kind.POP)),
    )
    for event, expected in [("push", "B"), ("push", "C"), ("pop", "B"), ("pop", "A")]:
        machine.raise_event(event)
        assert machine.state == expected


def test_pushes_without_end_forget_the_oldest_state(host):
    machine = started(
        host,
        state(host, "A", On("push", target="B", kind=Kind.PUSH), initial=True),
        state(host, "B", On("push", target="B", kind=Kind.PUSH), On("pop", kind=Kind.POP)),
    )
    host.take()
    for _ in range(REMEMBERED_STATES + 1):
        machine.raise_event("push")
    assert host.take().count("component.state_forgotten") == 1
    for _ in range(REMEMBERED_STATES):
        machine.raise_event("pop")
    assert machine.state == "B"
    assert done_at(machine, host, "pop") == ["component.nothing_to_pop"]


def test_messages_come_with_their_sender_and_events_with_nothing(host):
    seen = []
    machine = started(
        host,
        State(
            "A",
            initial=True,
            transitions=(
                On(Resume, do=(lambda *given: seen.append(given),), kind=Kind.INTERNAL),
                On("e", do=(lambda *given: seen.append(given),), kind=Kind.INTERNAL),
            ),
        ),
    )
    assert machine.receive(Resume(), SENDER)
    assert machine.raise_event("e")
    assert not machine.receive(Standby(), SENDER)
    assert seen == [(Resume(), SENDER), ()]


def test_what_an_action_raises_waits_until_the_transition_is_complete(host):
    machines = []

    def act(*_):
        assert machines[0].raise_event("second")
        host.done.append("act")

    machine = StateMachine(
        "test",
        (
            state(host, "A", On("first", do=(act,), target="B"), initial=True),
            state(host, "B", On("second", target="C")),
            state(host, "C"),
        ),
        host,
    )
    machines.append(machine)
    machine.start()
    assert done_at(machine, host, "first") == ["-A", "act", "+B", "-B", "+C"]


def test_chosen_tells_the_transition_without_taking_it(host):
    transition = On(QueryTime, do=(host.note("act"),), target="B")
    machine = started(host, state(host, "A", transition, initial=True), state(host, "B"))
    host.take()
    assert machine.chosen(QueryTime(), SENDER) is transition
    assert machine.chosen(Resume(), SENDER) is None
    assert (machine.state, host.take()) == ("A", [])


def test_conditions_are_joined():
    true, false = (lambda *_: True), (lambda *_: False)
    assert all_of(true, true)()
    assert not all_of(true, false)()
    assert any_of(false, true)(1, 2)
    assert not any_of(false, false)()
    assert negation(false)()
    assert not negation(true)()


class TestCore:
    """Machines that extend the states of the core services."""

    @pytest.fixture
    def machine(self, host):
        return started(
            host,
            state(host, REST, On("work", target=f"{WORK}.Busy")),
            state(host, WORK, On("stop", do=(host.note("act"),), target=REST)),
            state(host, f"{WORK}.Idle", On("go", target=f"{WORK}.Busy"), initial=True),
            state(host, f"{WORK}.Busy", On("inspect", target=f"{WORK}.Idle", kind=Kind.PUSH)),
            extends="Management",
        )

    def test_starts_in_the_core_state_and_follows_it_into_the_initial_state_inside(
        self, host, machine
    ):
        assert (machine.state, host.take()) == (REST, [f"+{REST}"])
        host.core = WORK
        machine.follow()
        assert machine.state == f"{WORK}.Idle"
        assert host.take() == [f"-{REST}", f"+{WORK}", f"+{WORK}.Idle"]

    def test_leaves_what_is_inside_when_the_core_moves(self, host, machine):
        host.core = WORK
        machine.follow()
        machine.raise_event("go")
        host.take()
        host.core = "Receiving.Ready.NotControlled.NotAvailable.Emergency"
        machine.follow()
        assert machine.state == host.core
        assert host.take() == [f"-{WORK}.Busy", f"-{WORK}"]

    def test_follow_without_a_change_does_nothing(self, host, machine):
        host.core = WORK
        machine.follow()
        machine.raise_event("go")
        host.take()
        machine.follow()
        assert (machine.state, host.take()) == (f"{WORK}.Busy", [])

    def test_a_modelled_transition_moves_the_core(self, host, machine):
        host.core = WORK
        machine.follow()
        host.take()
        machine.raise_event("stop")
        assert machine.state == REST
        left = [f"-{WORK}.Idle", f"-{WORK}"]
        assert host.take() == [*left, "act", f"request {REST}", f"+{REST}"]

    def test_a_target_inside_a_core_state_is_reached(self, host, machine):
        host.take()
        machine.raise_event("work")
        assert machine.state == f"{WORK}.Busy"
        assert host.take()[1:] == [f"request {WORK}.Busy", f"+{WORK}", f"+{WORK}.Busy"]

    def test_a_refused_core_state_leaves_the_machine_where_the_core_is(self, host, machine):
        host.may_enter = False
        host.take()
        machine.raise_event("work")
        assert machine.state == REST
        assert host.take() == [f"-{REST}", f"request {WORK}.Busy", f"+{REST}"]

    def test_a_pop_does_not_go_back_to_a_state_that_the_core_has_left(self, host, machine):
        host.core = WORK
        machine.follow()
        machine.raise_event("go")
        machine.raise_event("inspect")
        host.core = REST
        machine.follow()
        assert not machine._remembered

    def test_a_core_that_moves_during_an_action_is_followed_afterwards(self, host):
        def act(*_):
            host.core = REST
            machine.follow()
            host.done.append("act")

        machine = StateMachine(
            "test",
            (state(host, f"{WORK}.Idle", On("e", do=(act,), kind=Kind.INTERNAL), initial=True),),
            host,
            extends="Management",
        )
        host.core = WORK
        machine.start()
        assert done_at(machine, host) == ["act", f"-{WORK}.Idle"]
        assert machine.state == REST
