"""Management beyond its state table: silent reports, failing hooks, floods, lifted emergencies."""

from functools import partial

import pytest

from jausml.runtime import Guard, PeerSearch, Status
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.api import JausError
from jausml.runtime.messages import (
    ClearEmergency,
    ConfirmControl,
    QueryAuthority,
    QueryHeartbeatPulse,
    QueryStatus,
    RejectControl,
    ReleaseControl,
    ReportAuthority,
    ReportHeartbeatPulse,
    ReportStatus,
    RequestControl,
    Reset,
    Resume,
    SetEmergency,
    SetTime,
)

from .event_support import kill
from .state_tables import V1_0, Robot, core_services

ACCEPTED = ConfirmControl(response_code=0)
RELEASED = RejectControl(response_code=0)
NOT_AVAILABLE = RejectControl(response_code=1)


@pytest.fixture
def robot(world):
    return world.started("1.1.1", kind=Robot, default_authority=0, control_timeout=5)


@pytest.fixture
def client(world):
    return world.probe("2.1.1")


@pytest.fixture
def other(world):
    return world.probe("3.1.1")


@pytest.fixture
def standby(robot, client):
    """The robot, controlled and in Standby."""
    client.ask(RequestControl(authority_code=100), robot)
    robot.take()
    return robot


@pytest.fixture
def ready(standby, client):
    """The robot, controlled and in Ready."""
    client.ask(Resume(), standby)
    assert standby.status is Status.READY
    standby.take()
    return standby


@pytest.mark.parametrize("stands_by", [False, True])
@pytest.mark.parametrize("is_found", [False, True])
def test_a_silent_report_leads_to_standby_where_the_model_says_so(
    world, client, ready, stands_by, is_found
):
    """The paper's degraded mode: the component's own state says that a connection is inactive."""
    provider = world.started("1.1.7")
    told = []
    options = {"rate": 10.0, "silence_timeout": 0.5, "stands_by": stands_by}
    asked = (QueryHeartbeatPulse(), ReportHeartbeatPulse, lambda *_: None)
    if is_found:
        search = PeerSearch(("urn:jaus:jss:core:Liveness",))
        ready.subscribe_to_found(search, *asked, on_silence=told.append, **options)
    else:
        silent = partial(told.append, provider.address)
        ready.subscribe(provider.address, *asked, on_silence=silent, **options)
    world.run(2.0)
    client.ask(RequestControl(authority_code=100), ready)
    assert (told, ready.status) == ([], Status.READY)
    kill(world, provider)
    world.run(2.0)
    assert told == [provider.address]
    assert ready.status is (Status.STANDBY if stands_by else Status.READY)
    assert ready.take() == ["not ready"] * stands_by
    client.ask(Resume(), ready)
    assert ready.status is Status.READY


def test_a_provider_that_was_found_and_is_gone_leads_to_standby_too(world, client, ready):
    provider = world.started("1.1.7")
    ready.subscribe_to_found(
        PeerSearch(("urn:jaus:jss:core:Liveness",)),
        QueryHeartbeatPulse(),
        ReportHeartbeatPulse,
        lambda *_: None,
        rate=10.0,
        silence_timeout=3600.0,
        stands_by=True,
    )
    world.run(2.0)
    kill(world, provider)
    world.lost = lambda source, *_: source == provider.address
    for _ in range(30):
        client.ask(RequestControl(authority_code=100), ready)
        world.run(1.0)
    assert ready.status is Status.STANDBY
    assert ready.controller == client.address


def test_init_goes_to_standby_by_itself(world):
    robot = world.component("1.1.1", kind=Robot)
    assert robot.status is Status.INITIALIZE
    robot.start()
    assert robot.status is Status.STANDBY
    assert robot.take() == ["initialize"]


def test_hook_that_raises_is_counted(world, client):
    class Broken(Robot):
        def on_ready(self):
            raise RuntimeError("user code")

    robot = world.started("1.1.1", kind=Broken)
    client.tell(robot, RequestControl(authority_code=1), Resume())
    assert robot.status is Status.READY
    assert world.counters.snapshot()["component.handler_failed"] == 1
    assert client.ask(QueryStatus(), robot) == [ReportStatus(status=1, reserved=0)]


def test_initialization_that_fails_stays_in_failure(world):
    class Broken(Robot):
        def on_initialize(self):
            self.fail("no hardware")

    robot = world.started("1.1.1", kind=Broken)
    assert robot.status is Status.FAILURE


@pytest.mark.parametrize("hook", ["on_not_ready", "on_controller_changed"])
def test_reset_does_not_hide_a_failure_that_a_hook_reports(world, client, hook):
    robot = world.started("1.1.1", kind=Robot)
    client.tell(robot, RequestControl(authority_code=1), Resume())
    setattr(robot, hook, lambda *_: robot.fail("a brake is stuck"))
    client.ask(Reset(), robot)
    assert robot.status is Status.FAILURE


def test_hook_that_stops_the_component_at_its_start_leaves_nothing_behind(world):
    class Unwilling(Robot):
        def on_initialize(self):
            self.stop()

    robot = world.component("1.1.1", kind=Unwilling, heartbeat_rate=10.0, register_services=True)
    robot.discover("urn:jaus:jss:core:Time", lambda _found: None)
    robot.start()
    world.settle()
    sent = len(world.log)
    world.run(60.0, step=1.0)
    assert not robot.running
    assert len(world.log) == sent


class TestControlThatSurvivesAnEmergency:
    @pytest.fixture
    def robot(self, world):
        return world.started("1.1.1", kind=Robot, control_survives_emergency=True)

    def test_the_controller_stays_and_is_not_obeyed(self, ready, client, other):
        ready.handle(SetTime, lambda *_: ready.calls.append("obeyed"), when=Guard.CONTROLLED)
        client.send(SetTime(), ready)
        other.ask(SetEmergency(emergency_code=1), ready)
        assert client.take() == []
        assert ready.take() == ["obeyed", "not ready", "emergency True"]
        assert ready.controller == client.address
        assert client.ask(RequestControl(authority_code=100), ready) == [ACCEPTED]
        assert client.ask(Resume(), ready) == []
        assert client.ask(Reset(), ready) == []
        client.send(SetTime(), ready)
        assert other.ask(RequestControl(authority_code=200), ready) == [
            ConfirmControl(response_code=1)
        ]
        assert ready.status is Status.EMERGENCY
        assert ready.take() == []

    def test_after_that_of_version_1_0_it_has_what_it_asked_for_meanwhile(
        self, world, client, other
    ):
        services = core_services(V1_0, "Transport", "Events", "AccessControl", "Management")
        robot = world.started("1.1.1", services=services, control_survives_emergency=True)
        client.ask(RequestControl(authority_code=100), robot)
        other.ask(SetEmergency(emergency_code=1), robot)
        client.ask(RequestControl(authority_code=120), robot)
        other.ask(ClearEmergency(emergency_code=1), robot)
        assert (robot.controller, robot.authority) == (client.address, 120)

    def test_it_ends_when_the_emergency_is_lifted(self, world, ready, client, other):
        other.ask(SetEmergency(emergency_code=1), ready)
        client.take()
        world.run(10.1)
        ready.lift_emergency(other.address)
        assert ready.status is Status.STANDBY
        assert ready.controller is None
        assert client.take() == [RELEASED]

    def test_a_controller_that_is_gone_loses_control_after_it(self, world, ready, other):
        other.ask(SetEmergency(emergency_code=1), ready)
        world.run(20.0)
        assert ready.controller is not None
        other.ask(ClearEmergency(emergency_code=1), ready)
        world.run(5.1)
        assert ready.controller is None


class TestFloodOfRequests:
    def test_a_client_that_asks_again_at_once_is_answered_less_often(self, world, ready, other):
        """Such a client asks whenever it is refused."""
        refusals = []

        def again(_message, sender):
            refusals.append(world.time)
            rival.send(RequestControl(authority_code=1), sender)

        rival = world.component("4.1.1", services=())
        rival.on_message(ConfirmControl, again)
        rival.start()
        rival.send(RequestControl(authority_code=1), ready.address)
        world.run(5.0)
        assert len(refusals) == pytest.approx(50, abs=10)
        assert other.ask(RequestControl(authority_code=1), ready) == [
            ConfirmControl(response_code=2)
        ]

    def test_a_request_that_was_put_off_is_judged_when_it_is_answered(self, world, robot, other):
        robot.control_available = False
        for _ in range(30):
            other.send(RequestControl(authority_code=1), robot)
        world.settle()
        robot.control_available = True
        other.take()
        world.run(1.1)
        assert other.take() == [ACCEPTED]
        assert robot.controller == other.address

    def test_a_request_that_was_put_off_does_not_lower_a_later_one(self, world, ready, other):
        for _ in range(15):
            other.send(RequestControl(authority_code=50), ready)
        other.take()
        assert other.ask(RequestControl(authority_code=200), ready) == [ACCEPTED]
        world.run(1.1)
        assert ready.controller == other.address
        assert other.ask(QueryAuthority(), ready) == [ReportAuthority(authority_code=200)]

    def test_a_request_that_was_put_off_takes_no_control_away(self, world, other):
        robot = world.started("1.1.1", default_authority=10, control_timeout=0)
        for _ in range(15):
            other.send(RequestControl(authority_code=5), robot)
        other.take()
        other.ask(RequestControl(authority_code=50), robot)
        other.ask(Resume(), robot)
        world.run(1.1)
        assert other.take() == []
        assert (robot.controller, robot.status) == (other.address, Status.READY)

    def test_a_client_that_has_given_up_is_not_granted_control(self, world, ready, client, other):
        for _ in range(15):
            other.send(RequestControl(authority_code=50), ready)
        other.send(ReleaseControl(), ready)
        client.ask(ReleaseControl(), ready)
        other.take()
        world.run(1.1)
        assert ready.controller is None
        assert other.take() == []

    def test_the_last_of_the_requests_that_were_put_off_counts(self, world, ready, client, other):
        for authority in (*range(20, 35), 40):
            other.send(RequestControl(authority_code=authority), ready)
        client.ask(ReleaseControl(), ready)
        world.run(1.1)
        assert ready.controller == other.address
        assert other.ask(QueryAuthority(), ready) == [ReportAuthority(authority_code=40)]

    def test_another_reason_is_told_at_once(self, world, ready, other):
        def flood():
            for _ in range(30):
                other.send(RequestControl(authority_code=1), ready)
            return other.take()

        assert flood() == [ConfirmControl(response_code=2)] * 10
        ready.control_available = False
        assert flood() == [ConfirmControl(response_code=1)] * 10
        world.run(1.1)
        assert other.take() == [ConfirmControl(response_code=1)]

    def test_the_controller_is_confirmed_however_often_it_asks(self, ready, client):
        for _ in range(100):
            client.send(RequestControl(authority_code=100), ready)
        assert client.take() == [ACCEPTED] * 100

    @pytest.mark.slow
    def test_many_requesters_do_not_fill_the_memory(self, world, ready):
        for number in range(2000):
            world.probe(f"{number + 10}.1.1").send(RequestControl(authority_code=1), ready)
        world.settle()
        assert len(ready._jaus_access._refusals._counts) <= 256


class TestLift:
    """A way out of the emergency of somebody who is gone, for a person at the robot."""

    @pytest.fixture
    def stopped(self, ready, other):
        other.ask(SetEmergency(emergency_code=1), ready)
        ready.take()
        return ready

    def test_one_that_was_heard_a_moment_ago_stands(self, world, stopped, other):
        world.run(9.0)
        with pytest.raises(JausError, match=f"{other.address} was heard 9.0 s ago"):
            stopped.lift_emergency(other.address)
        assert stopped.status is Status.EMERGENCY
        assert stopped.take() == []

    def test_a_flood_of_emergencies_is_not_remembered(self, world, stopped):
        for number in range(1100):
            flood = world.probe(f"{number + 10}.1.1")
            flood.send(SetEmergency(emergency_code=1), stopped)
        world.settle()
        with pytest.raises(JausError, match=f"no emergency was set by {flood.address}"):
            stopped.lift_emergency(flood.address)

    def test_that_of_one_who_is_gone_ends_in_standby(self, world, stopped, other):
        world.run(10.1)
        stopped.lift_emergency(other.address)
        assert stopped.status is Status.STANDBY
        assert stopped.controller is None
        assert stopped.take() == ["emergency False"]
        assert world.counters.snapshot()["management.emergency_lifted"] == 1

    def test_somebody_else_can_stop_it_all_the_same(self, world, stopped, client, other):
        world.run(10.1)
        client.ask(SetEmergency(emergency_code=1), stopped)
        stopped.lift_emergency(other.address)
        assert stopped.status is Status.EMERGENCY
        client.ask(ClearEmergency(emergency_code=1), stopped)
        assert stopped.status is Status.STANDBY

    def test_a_wildcard_lifts_those_of_many_unless_one_is_there(self, world, stopped, client):
        everybody = JausAddress.parse("65535.255.255")
        world.run(10.1)
        client.ask(SetEmergency(emergency_code=1), stopped)
        with pytest.raises(JausError, match=str(client.address)):
            stopped.lift_emergency(everybody)
        world.run(10.1)
        stopped.lift_emergency(everybody)
        assert stopped.status is Status.STANDBY

    def test_nobody_who_set_none_is_named(self, stopped, other):
        with pytest.raises(JausError, match=f"no emergency was set by 9.9.9; by {other.address}"):
            stopped.lift_emergency(JausAddress(9, 9, 9))

    def test_a_component_that_has_failed_does_not_come_back_by_it(self, world, stopped, other):
        stopped.fail("broken")
        other.ask(SetEmergency(emergency_code=1), stopped)
        world.run(10.1)
        stopped.lift_emergency(other.address)
        assert stopped.status is Status.FAILURE

    def test_of_version_1_0_it_does_not_go_on_where_it_was(self, world, client, other):
        services = core_services(V1_0, "Transport", "Events", "AccessControl", "Management")
        component = world.started("1.1.1", kind=Robot, services=services)
        client.tell(component, RequestControl(authority_code=9), Resume())
        assert component.status is Status.READY
        other.ask(SetEmergency(emergency_code=1), component)
        world.run(10.1)
        component.lift_emergency(other.address)
        assert component.status is Status.STANDBY
        assert component.controller is None
