"""Elements that answers speak of."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import cache
from threading import Event

from jausml.authoring.proposals import elements
from jausml.authoring.proposals.fresh import free_name


def test_all_threads_get_the_same_library(monkeypatch):
    """Elements of two readings of it know nothing of each other."""
    second = Event()
    read = []

    def reading():
        read.append(object())
        if len(read) > 1:
            second.set()
        second.wait(0.2)
        return read[-1]

    monkeypatch.setattr(elements, "_library", cache(reading))
    with ThreadPoolExecutor(4) as threads:
        found = list(threads.map(lambda _: elements.library(), range(4)))
    assert found == read * 4


def test_a_name_of_any_length_can_be_made_unique():
    taken = ["x" * 2000]
    for _ in range(3):
        name = free_name("x" * 2000, taken)
        assert name not in taken
        taken.append(name)
    assert taken[2] != taken[3]
