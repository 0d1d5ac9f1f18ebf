"""Who else is here: other tabs, and other studios that have the same project open."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from studio_client import RefusedError, Server, serving, started

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from studio_client import Page

pytestmark = pytest.mark.ports

LOOK = {"name": "", "file": "catvehicle.xmi", "view": "system", "element": ""}


def named(name: str) -> Callable[[Any], bool]:
    return lambda told: any(each["name"] == name for each in told["pages"])


def without(name: str) -> Callable[[Any], bool]:
    return lambda told: not named(name)(told)


def test_a_tab_is_told_of_another_one_until_that_goes(page: Page, server: Server) -> None:
    with server.page() as other:
        chosen = {**LOOK, "name": " Ann \n of  boats ", "element": "catvehicle.xmi#//@nodes.0"}
        mine = other.ask("look", **chosen)["pages"]
        assert {each["id"] for each in mine} == {page.project["page"], other.project["page"]}
        told = page.await_told("presence", named("Ann of boats"))["pages"]
        assert [each["element"] for each in told if each["id"] == other.project["page"]] == [
            "catvehicle.xmi#//@nodes.0"
        ]
    page.await_told("presence", without("Ann of boats"))


def test_a_name_is_short(page: Page) -> None:
    told = page.ask("look", **{**LOOK, "name": "a" * 1000})["pages"]
    assert [each["name"] for each in told] == ["a" * 40]
    with pytest.raises(RefusedError, match="of that length"):
        page.ask("look", **{**LOOK, "element": "x" * 100_000})


@pytest.mark.slow
def test_another_studio_of_the_same_project_is_told_of_until_it_is_killed(
    page: Page, folder: Path, built: Path
) -> None:
    process = started(folder, built)
    try:
        assert process.stdout is not None
        address = process.stdout.readline().strip().removeprefix("jausml studio: ")
        with Server(process, address).page() as other:
            other.ask("look", **{**LOOK, "name": "Bo"})
            told = page.await_told("presence", named("Bo"))["pages"]
            assert [each["here"] for each in told if each["name"] == "Bo"] == [False]
            process.kill()
            page.await_told("presence", without("Bo"))
    finally:
        process.kill()
        process.communicate()


def test_a_studio_of_another_project_is_none_of_ours(
    page: Page, tmp_path: Path, built: Path
) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    with serving(elsewhere, built) as neighbour, neighbour.page() as other:
        other.ask("look", **{**LOOK, "name": "Cy"})
        assert page.ask("look", **LOOK)["pages"] == [
            {**LOOK, "id": page.project["page"], "here": True}
        ]
