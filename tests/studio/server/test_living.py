"""A running system is watched while a page looks; what it tells has the ids of the system view."""

import time

import pytest
from studio_client import LONGEST, Page, RefusedError

pytestmark = [pytest.mark.ports, pytest.mark.live]

FILE = "catvehicle.xmi"


def is_watched(page: Page) -> bool:
    """Tells it by what is answered to a question about a connection that is not there."""
    with pytest.raises(RefusedError) as refused:
        page.ask("live.message", connection="nothing")
    return "no system is watched" not in str(refused.value)


def test_ids_are_those_of_the_view(page):
    graph = page.ask("view", file=FILE, view="system")["graph"]
    page.ask("live.start", file=FILE)
    told = page.await_told("live")
    state = told["state"]
    of_bridges = {edge["id"] for edge in graph["edges"] if "bridgeConnections" in edge["id"]}
    assert of_bridges
    assert of_bridges <= state["edges"].keys()
    boxes = {node["id"] for node in graph["nodes"] if node["kind"] in ("component", "bridge")}
    assert state["boxes"].keys() == boxes
    page.await_told("live", lambda told: told["state"]["sources"].get("JAUS") == "nothing heard")
    assert page.ask("live.message", connection=state["connections"][0]["row"])["age"] is None


def test_who_looks_later_is_told_at_once_and_the_last_one_ends_it(server):
    with server.page() as first:
        first.ask("live.start", file=FILE)
        first.await_told("live")
        with server.page() as second:
            second.ask("live.start", file=FILE)
            second.await_told("live")
        assert is_watched(first)
    with server.page() as third:
        end = time.monotonic() + LONGEST
        while is_watched(third):
            assert time.monotonic() < end


def test_it_is_stopped_and_begun_again(page):
    assert not is_watched(page)
    page.ask("live.start", file=FILE)
    page.await_told("live")
    assert is_watched(page)
    page.ask("live.stop")
    assert not is_watched(page)
    page.told.clear()
    page.ask("live.start", file=FILE)
    page.await_told("live")


def test_a_file_that_is_not_there_is_refused(page, folder):
    for file in ("none.xmi", "../catvehicle.xmi", str(folder / "none.xmi")):
        with pytest.raises(RefusedError):
            page.ask("live.start", file=file)
    assert not is_watched(page)
