"""Elements that answers speak of."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import cache
from threading import Event

import pytest
from click.testing import CliRunner

from jausml.authoring.proposals import elements
from jausml.authoring.proposals.fresh import free_name
from jausml.cli.authoring.new_parts import component, node, service
from jausml.language.metamodel.classes import bridge, jaus


def test_all_threads_get_the_same_library(monkeypatch):
    """Elements of two readings of it know nothing of each other."""
    second = Event()
    read = []

    def reading(**_):
        read.append(object())
        if len(read) > 1:
            second.set()
        second.wait(0.2)
        return read[-1]

    monkeypatch.setattr(elements, "_library", cache(reading))
    with ThreadPoolExecutor(4) as threads:
        found = list(threads.map(lambda _: elements.library(), range(4)))
    assert found == read * 4


@pytest.mark.parametrize(
    ("verb", "arguments"),
    [(component, ["rover", "--provides", "Management"]), (service, ["Sonar"]), (node, ["camera"])],
)
def test_parts_are_added_without_reading_the_ready_maps(verb, arguments, monkeypatch, tmp_path):
    asked = set()
    real = elements._library

    def reading(*, with_maps):
        asked.add(with_maps)
        return real(with_maps=with_maps)

    monkeypatch.setattr(elements, "_library", reading)
    done = CliRunner().invoke(verb, [*arguments, "-m", str(tmp_path / "model.xmi")])
    assert done.exit_code == 0, done.output
    assert True not in asked


def test_the_library_without_maps_has_all_services():
    whole, parts = elements.library(), elements.library(with_maps=False)
    services = [[each.urn for each in of.instances(jaus.Service)] for of in (whole, parts)]
    assert services[0] == services[1]
    assert whole.instances(bridge.AttributeMap)
    assert not parts.instances(bridge.AttributeMap)


def test_a_name_of_any_length_can_be_made_unique():
    taken = ["x" * 2000]
    for _ in range(3):
        name = free_name("x" * 2000, taken)
        assert name not in taken
        taken.append(name)
    assert taken[2] != taken[3]
