"""Live tools with a component as the JAUS Tool Set generates it, on Junior."""

from contextlib import contextmanager
from dataclasses import replace
from threading import Event, Thread

import pytest

from jausml.live.peers.conformance.evidence import Verdict
from jausml.live.peers.conformance.run import CheckFilter, opened, run
from jausml.live.peers.conformance.session import Limits
from jausml.live.peers.makes.junior import JtsComponent
from jausml.live.peers.makes.vehicle import Place
from jausml.runtime.base.address import JausAddress

pytestmark = [pytest.mark.ports, pytest.mark.timeout(180)]

ADDRESS = JausAddress(126, 1, 199)
QUICK = {"timeout": 0.3, "quiet": 0.05}
NO_MESSAGE = "transport.no-message-code"
_DEAD_FOR = 2.0  # longer than a check waits for an answer


@pytest.fixture
def waypoint_driver(free_port):
    with JtsComponent(ADDRESS, Place(port=free_port)) as component:
        yield component


@contextmanager
def supervised(component):
    """Starts the component again whenever it has died."""
    end = Event()

    def watch():
        while not end.wait(0.05):
            if not component.alive:
                end.wait(_DEAD_FOR)
                component.restart()

    thread = Thread(target=watch)
    thread.start()
    yield
    end.set()
    thread.join()


def checked(network, catalogue, *only, skip=(), limits=None):
    selection = CheckFilter(frozenset(only), frozenset(skip))
    limits = limits or Limits(restart=1.0)
    with opened(network, ADDRESS, catalogue, limits=limits, **QUICK) as session:
        return run(session, selection.groups(), lambda _: None)


@pytest.mark.usefixtures("waypoint_driver")
def test_all_its_services_are_listed(jausml):
    result = jausml("ocu", "services", str(ADDRESS))
    assert result.stdout.splitlines() == [
        "urn:jaus:jss:mobility:LocalPoseSensor 1.0",
        "urn:jaus:jss:mobility:LocalWaypointListDriver 1.0",
    ]
    result = jausml("ocu", "discover", "--duration", "0.6")
    assert "LocalPoseSensor 1.0\n      urn:jaus:jss:mobility:LocalWaypointList" in result.stdout


@pytest.mark.usefixtures("waypoint_driver")
def test_its_controller_is_unknown_and_not_absent(jausml):
    result = jausml("ocu", input="control 126.1.199\nresume\nstatus\nstatus\nrelease\n")
    assert result.exit_code == 0, result.output
    assert result.stdout.count("126.1.199 READY; controller unknown") == 2
    assert "126.1.199 is released" in result.stdout


@pytest.mark.usefixtures("waypoint_driver")
def test_it_is_commanded_to_the_end(jausml):
    words = ("ocu", "command", str(ADDRESS), "SetTravelSpeed", '{"Speed": 1}')
    result = jausml(*words, "--rate", "10", "--duration", "3")
    assert result.exit_code == 0, result.stderr
    assert "times" in result.stderr
    assert " of them when" not in result.stderr


@pytest.mark.usefixtures("waypoint_driver")
def test_what_it_leaves_unanswered_is_told_as_that(jausml):
    words = ("ocu", "watch", str(ADDRESS), "LocalPose", "--rate", "1", "--timeout", "0.5")
    result = jausml(*words)
    assert result.exit_code == 2
    assert "126.1.199 answers (" in result.stderr
    assert "but not CreateEvent: it provides LocalPoseSensor" in result.stderr


@pytest.mark.slow
@pytest.mark.usefixtures("waypoint_driver")
def test_what_it_inherits_is_checked_though_it_announces_the_leaf_alone(network, catalogue):
    report = checked(network, catalogue, "access", "management", "events")
    found = {result.check.id: result for result in report.results}
    assert found["management.resume"].verdict is Verdict.PASS
    assert found["access.request"].verdict is Verdict.NOTE
    assert found["access.uncontrolled"].verdict is Verdict.FAIL
    (first, *others) = (result for result in report.results if result.check.group == "events")
    assert first.verdict is Verdict.FAIL
    assert "inherits Events, but QueryEvents is not answered" in first.messages[0]
    assert {other.messages[0] for other in others} == {
        f"the group could not begin; see {first.check.id}"
    }


@pytest.mark.slow
def test_it_dies_of_the_last_checks_and_not_before(network, catalogue, waypoint_driver):
    report = checked(network, catalogue, "transport", "management.resume")
    ids = [result.check.id for result in report.results]
    died = ids.index(NO_MESSAGE)
    assert ids.index("management.resume") < died
    assert report.results[died].left_silent
    assert not waypoint_driver.alive
    assert all(result.verdict is Verdict.SKIPPED for result in report.results[died + 1 :])
    assert len(report.results[died + 1 :]) < 4


@pytest.mark.slow
def test_a_target_that_comes_back_is_tested_further(network, catalogue, waypoint_driver):
    with supervised(waypoint_driver):
        report = checked(network, catalogue, "transport", limits=Limits(restart=20.0))
    results = {result.check.id: result for result in report.results}
    assert results[NO_MESSAGE].verdict is Verdict.FAIL
    gone = "the target does not answer any more"
    assert [result.check.id for result in report.results if result.messages == (gone,)] == []


def test_a_check_can_be_left_out(network, catalogue, waypoint_driver):
    report = checked(network, catalogue, "transport", skip=(NO_MESSAGE,))
    ids = {result.check.id for result in report.results}
    assert NO_MESSAGE not in ids
    assert "transport.truncated-bodies" in ids
    assert waypoint_driver.alive


def test_the_selection_of_a_check_is_of_its_group_alone():
    selection = CheckFilter(frozenset({"access.request", "list"}), frozenset({"list.elements"}))
    assert [group.name for group in selection.groups()] == ["access", "list"]
    assert selection.takes("access.request")
    assert not selection.takes("access.release")
    assert not selection.takes("list.elements")
    assert replace(selection, only=frozenset()).takes("access.release")
