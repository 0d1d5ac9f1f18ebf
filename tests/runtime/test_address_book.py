import socket

import pytest

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.transports.address_book import AddressBook, Doubt

ROBOT = JausAddress(100, 1, 1)
HERE, THERE = ("127.0.0.1", 4000), ("127.0.0.2", 4001)


@pytest.fixture
def counters() -> Counters:
    return Counters()


@pytest.fixture
def book(counters: Counters) -> AddressBook:
    return AddressBook(10.0, counters)


def test_the_newest_endpoint_wins_over_older_and_configured_ones(book, counters):
    assert book.find(ROBOT) is None
    book.configure({ROBOT: HERE})
    assert book.find(ROBOT) == HERE
    book.learn(ROBOT, THERE, 0.0)
    assert book.find(ROBOT) == THERE
    book.learn(ROBOT, HERE, 1.0)
    assert book.find(ROBOT) == HERE
    assert counters.snapshot() == {"transport.address_changed": 2}


def test_a_host_name_is_resolved_once_and_an_unknown_one_left_out(book, counters, monkeypatch):
    def resolve(host: str) -> str:
        if host != "robot":
            raise socket.gaierror(-2, "unknown")
        return "192.0.2.5"

    monkeypatch.setattr(socket, "gethostbyname", resolve)
    other = JausAddress(1, 1, 1)
    book.configure({ROBOT: ("robot", 3794), other: ("nowhere", 3794)})
    assert book.find(ROBOT) == ("192.0.2.5", 3794)
    assert book.find(other) is None
    assert counters.snapshot() == {"transport.unresolved_host": 1}


def test_a_silent_component_is_asked_and_then_searched(book):
    book.learn(ROBOT, HERE, 0.0)
    assert book.doubt(ROBOT, 9.9) is Doubt.NONE
    assert book.doubt(ROBOT, 10.0) is Doubt.ASK
    assert book.doubt(ROBOT, 10.5) is Doubt.NONE
    assert book.doubt(ROBOT, 11.0) is Doubt.SEARCH
    assert book.doubt(ROBOT, 11.5) is Doubt.NONE
    assert book.doubt(ROBOT, 12.0) is Doubt.SEARCH
    book.learn(ROBOT, HERE, 12.1)
    assert book.doubt(ROBOT, 20.0) is Doubt.NONE
    assert book.doubt(ROBOT, 22.2) is Doubt.ASK


def test_a_configured_component_is_asked_first(book):
    book.configure({ROBOT: HERE})
    assert book.doubt(ROBOT, 0.0) is Doubt.ASK
    assert book.doubt(ROBOT, 1.0) is Doubt.SEARCH


@pytest.mark.parametrize("configured", [True, False])
def test_a_component_that_did_not_acknowledge_is_searched_at_once(book, configured):
    if configured:
        book.configure({ROBOT: HERE})
    else:
        book.learn(ROBOT, HERE, 100.0)
    book.suspect(ROBOT, 100.5)
    assert book.doubt(ROBOT, 101.0) is Doubt.SEARCH
    book.suspect(JausAddress(9, 9, 9), 101.0)


def test_a_component_that_is_heard_acknowledges_late_and_is_not_searched(book):
    book.learn(ROBOT, HERE, 100.0)
    book.suspect(ROBOT, 99.5)
    assert book.doubt(ROBOT, 101.0) is Doubt.NONE


def test_a_flood_of_sources_forgets_the_silent_and_keeps_the_configured(book, counters):
    book.configure({ROBOT: HERE})
    talker = JausAddress(5000, 1, 1)
    for subsystem in range(1, 3000):
        book.learn(JausAddress(subsystem, 2, 2), THERE, float(subsystem))
        book.learn(talker, HERE, float(subsystem))
    assert len(book.learnt) == 1024
    assert book.find(talker) == HERE
    assert book.find(ROBOT) == HERE
    assert book.find(JausAddress(1, 2, 2)) is None
    assert counters.snapshot()["transport.address_book_full"] == 3000 - 1024
