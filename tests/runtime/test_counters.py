import logging

from jausml.runtime.base.counters import Counters

from .transport_support import in_threads


def test_a_flood_of_one_name_is_one_line_each_interval(caplog, clock):
    counters = Counters(clock, log_interval=5.0)
    for _ in range(100):
        counters.count("judp.bad_version", "from a stranger")
    counters.count("judp.truncated")
    assert [record.getMessage() for record in caplog.records] == [
        "judp.bad_version (1 times): from a stranger",
        "judp.truncated (1 times): ",
    ]
    clock.time += 5.0
    counters.count("judp.bad_version", "again")
    assert caplog.records[-1].getMessage() == "judp.bad_version (100 times): again"
    assert counters.snapshot() == {"judp.bad_version": 101, "judp.truncated": 1}


def test_ordinary_traffic_is_not_logged(caplog):
    counters = Counters()
    counters.add("judp.sent")
    counters.add("judp.sent", 4)
    assert counters.snapshot() == {"judp.sent": 5}
    assert not caplog.records


def test_an_error_is_logged_with_its_traceback(caplog):
    Counters().count("loop.callback_failed", error=RuntimeError("boom"))
    assert caplog.records[0].exc_info is not None
    assert "boom" in str(caplog.records[0].exc_info[1])


def test_no_count_is_lost_between_threads():
    counters = Counters()

    def work(_index: int) -> None:
        for _ in range(2000):
            counters.add("n")

    in_threads(work)
    assert counters.snapshot() == {"n": 8000}


def test_a_snapshot_is_a_sorted_copy():
    counters = Counters()
    counters.add("b")
    counters.add("a")
    snapshot = counters.snapshot()
    snapshot["a"] = 99
    assert list(counters.snapshot().items()) == [("a", 1), ("b", 1)]


def test_drops_are_told_apart_from_traffic():
    counters = Counters()
    counters.add("judp.sent")
    counters.count("judp.truncated")
    counters.count("judp.bad_version")
    assert list(counters.drops().items()) == [("judp.bad_version", 1), ("judp.truncated", 1)]


def test_errors_are_logged_as_such(caplog):
    counters = Counters()
    counters.count("bridge.a", "worse", level=logging.ERROR)
    counters.count("bridge.b", "bad")
    assert [(record.levelname, record.message) for record in caplog.records] == [
        ("ERROR", "bridge.a (1 times): worse"),
        ("WARNING", "bridge.b (1 times): bad"),
    ]
