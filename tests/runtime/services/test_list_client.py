"""Lists of other components: set, deleted and read back."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.language.semantics.connections.calls import ELEMENTS
from jausml.runtime import ElementList, JausComponent, ServiceIdentity, Status, chain
from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.messages import (
    ConfirmElementRequest,
    DeleteElement,
    QueryElement,
    QueryElementList,
    ReportElement,
    SetElement,
)
from jausml.runtime.services.list_elements import ELEMENTS_OF_DRIVERS, ListElement
from jausml.runtime.services.list_manager import ListError
from jausml.runtime.wire.message import EncodeError

from .state_tables import CORE_NAMES, V1_1, core_services

TARGET = JausAddress(1, 1, 1)
SERVICES = (
    *core_services(V1_1, *CORE_NAMES),
    ServiceIdentity("urn:jaus:jss:core:ListManager", 1, 1),
)


class Robot(JausComponent):
    def supports_element(self, element):
        return element.data.startswith(b"ok")


class Outcome:
    """What the client was told."""

    def __init__(self):
        self.done = 0
        self.refused = []
        self.lists = []
        self.failures = 0

    def is_done(self):
        self.done += 1

    def has_failed(self):
        self.failures += 1

    def callbacks(self):
        return {"on_done": self.is_done, "on_refused": self.refused.append}


@pytest.fixture
def robot(world):
    return world.started(
        str(TARGET), kind=Robot, services=SERVICES, max_list_elements=600, control_timeout=0
    )


@pytest.fixture
def client(world, robot):
    component = world.started("2.1.1", services=())
    component.control(TARGET, authority=100)
    world.settle()
    assert robot.status is Status.READY
    return component


@pytest.fixture
def outcome():
    return Outcome()


def elements(count, *, circular=False, size=2, first=1):
    data = b"ok".ljust(size, b".")
    return chain([(first + number, data, 1) for number in range(count)], circular=circular)


@pytest.mark.parametrize("circular", [False, True])
@pytest.mark.parametrize(
    ("count", "size", "requests"),
    [(0, 2, 0), (1, 2, 1), (255, 2, 3), (600, 2, 5), (7, 1000, 7), (3, 5000, 3)],
)
def test_set_and_read_back(world, robot, client, outcome, circular, count, size, requests):
    wanted = elements(count, circular=circular, size=size)
    client.set_list(TARGET, elements(5, first=900))
    world.settle()
    sent = world.count(SetElement.CODE)
    client.set_list(TARGET, wanted, **outcome.callbacks())
    world.settle()
    assert (outcome.done, outcome.refused) == (1, [])
    assert list(robot.elements) == wanted
    assert world.count(SetElement.CODE) - sent == requests
    client.read_list(TARGET, outcome.lists.append)
    world.settle()
    assert outcome.lists == [tuple(wanted)]


def test_refusal_ends_it(world, robot, client, outcome):
    bad = chain([(1, b"ok", 1), (2, b"no", 1)])
    client.set_list(TARGET, bad, **outcome.callbacks())
    world.run(10.0, step=0.5)
    assert (outcome.done, outcome.refused) == (0, [4])
    assert len(robot.elements) == 0


def test_lost_requests_and_answers_are_made_up_for(world, robot, client, outcome):
    numbers = {SetElement.CODE: 0, ConfirmElementRequest.CODE: 0}

    def lost(_source, _destination, code):
        if code not in numbers:
            return False
        numbers[code] += 1
        return numbers[code] % 2 == 1

    world.lost = lost
    client.set_list(TARGET, elements(600), **outcome.callbacks())
    world.run(60.0, step=0.5)
    assert (outcome.done, outcome.refused) == (1, [])
    assert list(robot.elements) == elements(600)


def test_no_answer(world, robot, client, outcome):
    world.detach(robot.address)
    client.set_list(TARGET, elements(3), timeout=1.0, retries=2, **outcome.callbacks())
    world.run(5.0, step=0.5)
    assert (outcome.done, outcome.refused) == (0, [None])
    assert world.count(DeleteElement.CODE) == 3


def test_delete(world, robot, client, outcome):
    client.set_list(TARGET, elements(3))
    client.delete_elements(TARGET, [2], **outcome.callbacks())
    world.settle()
    assert outcome.done == 1
    assert [element.uid for element in robot.elements] == [1, 3]
    client.delete_elements(TARGET, [2], **outcome.callbacks())
    world.settle()
    assert outcome.refused == [5]


def test_cancel(world, robot, client, outcome):
    request = client.set_list(TARGET, elements(600), **outcome.callbacks())
    request.cancel()
    world.run(10.0, step=0.5)
    assert (outcome.done, outcome.refused, len(robot.elements)) == (0, [], 0)


def test_before_the_start(world, robot, outcome):
    late = world.component("3.1.1", services=())
    late.set_list(robot.address, elements(1), **outcome.callbacks())
    late.read_list(robot.address, outcome.lists.append)
    late.start()
    world.run(5.0, step=0.5)
    assert outcome.refused == [None], "it is not controlled"
    assert outcome.lists == [()]


def test_read_of_an_element_that_vanishes(world, client, outcome):
    client.set_list(TARGET, elements(2))
    world.settle()
    world.lost = lambda _source, _destination, code: code == ReportElement.CODE
    client.read_list(
        TARGET, outcome.lists.append, on_failure=outcome.has_failed, timeout=1.0, retries=2
    )
    world.run(5.0, step=0.5)
    assert (outcome.lists, outcome.failures) == ([], 1)
    assert world.count(QueryElement.CODE) == 3


def test_late_report_of_another_element_is_not_mixed_up(world, outcome):
    probe = world.probe("5.1.1", strict=False)
    reader = world.started("2.1.1", services=())
    reader.read_list(probe.address, outcome.lists.append)
    source = world.component("6.1.1", kind=Robot, services=SERVICES)
    source.elements.set(elements(1))
    source.start()
    (order,) = probe.ask(QueryElementList(), source)
    (report,) = probe.ask(QueryElement(element_uid=1), source)
    probe.send(order, reader)
    stale = ReportElement(element_uid=77, element_data=report.element_data)
    probe.tell(reader, stale, report)
    assert outcome.lists == [tuple(elements(1))]


def test_impossible_requests(client):
    with pytest.raises(ValueError, match="one component"):
        client.delete_elements(BROADCAST, [1])
    with pytest.raises(EncodeError):
        client.delete_elements(TARGET, [70000])
    with pytest.raises(EncodeError):
        client.delete_elements(TARGET, [1] * 256)


# ---- the list itself -------------------------------------------------------------------------

UIDS = st.integers(0, 6)
REQUEST = st.lists(st.tuples(UIDS, UIDS, UIDS), min_size=1, max_size=4)


def assert_valid(tested):
    """Checks the five rules of a valid list (AS5710, ListManager)."""
    links = {element.uid: (element.previous_uid, element.next_uid) for element in tested}
    if not links:
        return
    heads = [uid for uid, (previous, _) in links.items() if previous == 0]
    assert len(heads) == 1
    order = [element.uid for element in tested]
    assert order[0] == heads[0]
    for before, after in pairwise(order):
        assert links[before][1] == after
        assert links[after][0] == before
    assert links[order[-1]][1] in (0, order[0])
    assert all(uid not in links[uid] for uid in order)


@given(st.lists(st.one_of(REQUEST, st.lists(UIDS, min_size=1, max_size=3)), max_size=12))
def test_list_stays_valid_whatever_is_asked_for(requests):
    tested = ElementList(5)
    for request in requests:
        before = list(tested)
        try:
            if isinstance(request[0], tuple):
                tested.set([ListElement(*links) for links in request])
                asked = {uid for uid, _, _ in request}
                assert asked <= {element.uid for element in tested}
            else:
                tested.delete(request)
                assert not set(request) & {element.uid for element in tested}
        except ListError:
            assert list(tested) == before
        assert_valid(tested)
        assert len(tested) <= 5


def test_both_know_the_same_elements():
    assert ELEMENTS == ELEMENTS_OF_DRIVERS
