"""Components with state machines among peers: control, emergencies, queries and events."""

import pytest

from jausml.language.semantics.jaus.inherited_machines import core_machine
from jausml.runtime import Guard, Status
from jausml.runtime.component.modelled import CORE_STATES, ModelledComponent
from jausml.runtime.component.state_machine import Kind, On, State
from jausml.runtime.messages import (
    ClearEmergency,
    ConfirmControl,
    CreateEvent,
    Event,
    QueryTime,
    ReleaseControl,
    ReportTime,
    RequestControl,
    Reset,
    Resume,
    SetEmergency,
    SetTime,
    Standby,
)

WORK = "Receiving.Ready.Controlled.Available.Ready"
SENT = ReportTime()


class Worker(ModelledComponent):
    """Takes SetTime in Ready from its controller, and reports in Ready alone."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.calls = []
        self.machine = self.add_machine(
            "ReceiveFSM",
            (
                State(
                    WORK,
                    entry=(self.begin,),
                    exit=(self.end,),
                    transitions=(
                        On("Broken", target="Receiving.Ready.NotControlled.NotAvailable.Failure"),
                        On("Tired", target="Receiving.Ready.Controlled.Available.Standby"),
                        On("Done", target="Receiving.Ready.NotControlled.Available.Standby"),
                        On("Off", target="Receiving.Ready.NotControlled.NotAvailable.Shutdown"),
                        On(QueryTime, do=(self.report_time,), kind=Kind.INTERNAL),
                        On("Tell", do=(self.report_time,), kind=Kind.INTERNAL),
                        On("Crash", do=(self.crash,), kind=Kind.INTERNAL),
                        On("Timedout", do=(self.late,), kind=Kind.INTERNAL),
                        On("Failure", do=(self.failing,), kind=Kind.INTERNAL),
                    ),
                ),
                State(
                    f"{WORK}.Idle",
                    initial=True,
                    transitions=(
                        On(SetTime, when=self.is_controlling_client, target=f"{WORK}.Busy"),
                    ),
                ),
                State(f"{WORK}.Busy"),
            ),
            extends="Management",
        )
        self.handle_by_machines(SetTime)
        self.provide_by_machines(QueryTime, ReportTime, self.report_time)

    def begin(self):
        self.calls.append("begin")

    def end(self):
        self.calls.append("end")

    def late(self):
        self.calls.append("late")

    def failing(self):
        self.calls.append("failing")

    def crash(self):
        raise ValueError("crash")

    def report_time(self, _message=None, _sender=None):
        self.calls.append("report")
        return SENT

    @property
    def state(self):
        return self.machine.state

    def take(self):
        calls, self.calls = self.calls, []
        return calls


@pytest.fixture
def worker(world):
    return world.started("1.1.1", kind=Worker, control_timeout=5)


@pytest.fixture
def client(world):
    return world.probe("2.1.1")


@pytest.fixture
def ready(worker, client):
    client.tell(worker, RequestControl(authority_code=100), Resume())
    assert worker.state == f"{WORK}.Idle"
    assert worker.take() == ["begin"]
    return worker


def count(world, name):
    return world.counters.snapshot().get(name, 0)


def test_core_states_are_those_of_the_model():
    assert set(CORE_STATES.values()) == set(core_machine(None).leaves)


def test_starts_where_the_core_is_and_follows_control_and_readiness(worker, client):
    assert worker.state == "Receiving.Ready.NotControlled.Available.Standby"
    client.ask(RequestControl(authority_code=100), worker)
    assert worker.state == "Receiving.Ready.Controlled.Available.Standby"
    client.ask(Resume(), worker)
    assert worker.state == f"{WORK}.Idle"
    client.ask(Standby(), worker)
    assert worker.state == "Receiving.Ready.Controlled.Available.Standby"
    client.ask(ReleaseControl(), worker)
    assert worker.state == "Receiving.Ready.NotControlled.Available.Standby"
    assert worker.take() == ["begin", "end"]


def test_takes_a_command_of_the_controller_alone(world, ready, client):
    world.probe("3.1.1").ask(SetTime(), ready)
    assert ready.state == f"{WORK}.Idle"
    assert count(world, "component.no_transition") == 1
    client.ask(SetTime(), ready)
    assert ready.state == f"{WORK}.Busy"


@pytest.mark.parametrize("loss", ["release", "timeout", "emergency", "standby"])
def test_whatever_ends_ready_runs_the_exit(world, ready, client, loss):
    client.ask(SetTime(), ready)
    if loss == "release":
        client.ask(ReleaseControl(), ready)
    elif loss == "timeout":
        world.run(6.0, step=0.5)
    elif loss == "emergency":
        client.ask(SetEmergency(), ready)
    else:
        client.ask(Standby(), ready)
    assert ready.take() == (["late", "end"] if loss == "timeout" else ["end"])
    client.take()
    client.ask(SetTime(), ready)
    assert not ready.state.startswith(WORK)


def test_emergency_and_back(ready, client):
    client.ask(SetEmergency(), ready)
    assert ready.state == "Receiving.Ready.NotControlled.NotAvailable.Emergency"
    client.ask(ClearEmergency(), ready)
    assert ready.state == "Receiving.Ready.NotControlled.Available.Standby"


@pytest.mark.parametrize(
    ("event", "status", "controlled"),
    [
        ("Tired", Status.STANDBY, True),
        ("Done", Status.STANDBY, False),
        ("Broken", Status.FAILURE, False),
        ("Off", Status.SHUTDOWN, False),
    ],
)
def test_a_modelled_transition_moves_the_core(ready, event, status, controlled):
    ready.raise_event(event)
    assert ready.status is status
    assert (ready.controller is not None) is controlled
    assert ready.state == ready.core_state()
    assert ready.take()[0] == "end"


def test_failure_is_an_event_before_it_is_a_state(ready):
    ready.fail("test")
    assert ready.take() == ["failing", "end"]


def test_reset_starts_the_machine_again(ready, client):
    client.ask(Reset(), ready)
    assert ready.take() == ["end"]
    assert ready.state == "Receiving.Ready.NotControlled.Available.Standby"


def test_queries_are_answered_where_a_transition_says_so(world, worker, client):
    assert client.ask(QueryTime(), worker) == []
    assert count(world, "component.no_transition") == 1
    client.tell(worker, RequestControl(authority_code=100), Resume())
    assert client.ask(QueryTime(), worker) == [SENT]


def test_events_carry_what_the_transition_of_the_state_reports(world, worker, client):
    query = QueryTime().encode()
    request = CreateEvent(event_type=0, requested_periodic_rate=10.0, query_message=query)
    client.ask(request, worker)
    world.run(0.5)
    assert not client.take(Event)
    client.tell(worker, RequestControl(authority_code=100), Resume())
    world.run(0.5)
    events = client.take(Event)
    assert 3 <= len(events) <= 7
    assert all(event.report_message == SENT.encode() for event in events)


def test_a_message_of_an_event_goes_to_the_controller(ready, client):
    client.take()
    ready.raise_event("Tell")
    assert client.take() == [SENT]


def test_an_action_that_raises_is_counted_and_harms_nothing(world, ready):
    ready.raise_event("Crash")
    assert count(world, "component.handler_failed") == 1
    assert ready.state == f"{WORK}.Idle"


def test_an_event_that_nobody_takes_is_counted(world, worker):
    worker.raise_event("Tired")
    assert count(world, "component.no_transition") == 1


def test_standard_guards(worker, client):
    client.ask(RequestControl(authority_code=100), worker)
    assert worker.is_controlling_client(Resume(), client.address)
    assert not worker.is_controlling_client(Resume(), worker.address)
    assert not worker.is_controlling_client()
    assert worker.is_control_available()
    client.ask(SetEmergency(), worker)
    assert worker.is_id_stored(Resume(), client.address)
    assert not worker.is_id_stored(Resume(), worker.address)
    assert not worker.is_control_available()


class Free(ModelledComponent):
    """Has a machine that stands for itself."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        states = (
            State("Off", initial=True, transitions=(On(SetTime, target="On"),)),
            State("On", transitions=(On(SetTime, target="Off"), On("Tell", do=(self.tell,)))),
        )
        self.machine = self.add_machine("Free", states)
        self.handle_by_machines(SetTime, when=Guard.READY)

    def tell(self):
        return ConfirmControl(response_code=0)


def test_a_machine_of_its_own_takes_commands_as_a_handler_would(world, client):
    free = world.started("1.1.1", kind=Free)
    client.ask(SetTime(), free)
    assert free.machine.state == "Off"
    assert count(world, "component.command_refused") == 1
    client.tell(free, RequestControl(authority_code=100), Resume(), SetTime())
    assert free.machine.state == "On"


def test_a_message_without_a_receiver_is_counted(world):
    free = world.started("1.1.1", kind=Free)
    free.machine.raise_event("Tell")
    free._jaus_take(SetTime(), free.address)
    free.machine.raise_event("Tell")
    assert count(world, "component.no_receiver") == 1


def test_a_machine_of_its_own_starts_again_at_reset(world, client):
    free = world.started("1.1.1", kind=Free)
    client.tell(free, RequestControl(authority_code=100), Resume(), SetTime(), Reset())
    assert free.machine.state == "Off"


class Twice(ModelledComponent):
    """Two services that take the same messages."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.taken = 0
        for name in ("First", "Second"):
            transition = On(QueryTime, do=(self.note, self.report_time), kind=Kind.INTERNAL)
            self.add_machine(name, (State("A", initial=True, transitions=(transition,)),))
        self.provide_by_machines(QueryTime, ReportTime, self.report_time)

    def note(self, _message, _sender):
        self.taken += 1

    def report_time(self, _message, _sender):
        return SENT


def test_services_that_take_the_same_query_answer_it_once(world, client):
    twice = world.started("1.1.1", kind=Twice)
    for count_of_queries in (1, 2):
        assert client.ask(QueryTime(), twice) == [SENT]
        assert twice.taken == 2 * count_of_queries


AVAILABLE = "Receiving.Ready.Controlled.Available"
AWAY = "Receiving.Ready.Controlled.NotAvailable"


class Spooler(ModelledComponent):
    """Refines the states of AccessControl, whatever Management does besides."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        self.machine = self.add_machine(
            "ReceiveFSM",
            (
                State(
                    f"{AVAILABLE}.Waiting",
                    initial=True,
                    transitions=(
                        On("Work", target=f"{AWAY}.Working", kind=Kind.PUSH),
                        On("Leave", target="Receiving.Ready.NotControlled.Available"),
                    ),
                ),
                State(f"{AWAY}.Working", transitions=(On("Done", kind=Kind.POP),)),
                State(f"{AWAY}.Broken", initial=True),
                State(
                    "Receiving.Ready.NotControlled",
                    transitions=(On("Work", target=f"{AVAILABLE}.Waiting"),),
                ),
            ),
            extends="AccessControl",
        )


@pytest.fixture
def spooler(world, client):
    component = world.started("1.1.1", kind=Spooler, control_timeout=5)
    assert component.machine.state == "Receiving.Ready.NotControlled.Available"
    client.ask(RequestControl(authority_code=100), component)
    assert component.machine.state == f"{AVAILABLE}.Waiting"
    return component


def test_what_management_does_is_nothing_to_a_machine_that_extends_access_control(spooler, client):
    client.ask(Resume(), spooler)
    assert spooler.status is Status.READY
    assert spooler.machine.state == f"{AVAILABLE}.Waiting"


def test_a_machine_may_make_control_unavailable_and_come_back(spooler, client, world):
    spooler.raise_event("Work")
    assert (spooler.machine.state, spooler.control_available) == (f"{AWAY}.Working", False)
    (refused,) = world.probe("3.1.1").ask(RequestControl(authority_code=200), spooler)
    assert refused.response_code == ConfirmControl.ResponseCode.NOT_AVAILABLE
    assert spooler.controller == client.address
    spooler.raise_event("Done")
    assert (spooler.machine.state, spooler.control_available) == (f"{AVAILABLE}.Waiting", True)


def test_a_machine_follows_who_makes_control_unavailable(spooler, client):
    spooler.control_available = False
    assert spooler.machine.state == f"{AWAY}.Broken"
    spooler.control_available = True
    client.ask(SetEmergency(), spooler)
    assert spooler.machine.state == "Receiving.Ready.NotControlled.NotAvailable"


def test_a_machine_lets_go_of_its_controller_and_does_not_take_one(spooler, world):
    spooler.raise_event("Leave")
    assert spooler.controller is None
    assert spooler.machine.state == "Receiving.Ready.NotControlled.Available"
    spooler.raise_event("Work")
    assert spooler.machine.state == "Receiving.Ready.NotControlled.Available"
    assert count(world, "component.core_state_refused") == 1


def test_private_attributes_of_a_subclass_do_not_meet_those_of_the_base(world):
    """A user's `self._events` once replaced the Events service of the component."""
    component = world.component("1.1.1")
    private = [name for name in vars(component) if name.startswith("_")]
    assert private
    assert [name for name in private if not name.startswith("_jaus_")] == []
