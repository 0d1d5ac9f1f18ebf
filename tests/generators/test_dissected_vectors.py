"""The vectors of tests/vectors in the dissector, which runs in Lua without Wireshark.

In tests/live/test_wireshark.py tshark shows them.
"""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from for_each import for_each
from lupa import lua54
from wire_vectors import VECTORS, payload_of, vectors

from jausml.language.metamodel.classes import jaus
from jausml.language.model import read_models
from jausml_generators.wireshark.target import DissectorView
from tests.live.wireshark_bodies import tells
from tests.live.wireshark_support import Shown, SystemOfNothing, datagram, write_dissector

STUB = Path(__file__).parents[1] / "support" / "wireshark.lua"
DECODED = [vector for vector in vectors() if "payload" in vector]


def utf8(value: str) -> str:
    """Returns a text of Lua, which has bytes."""
    return value.encode("latin-1").decode("utf-8")


Dissect = Callable[[dict[str, Any]], tuple[DissectorView, list[Shown]]]


@pytest.fixture(scope="module")
def dissect(tmp_path_factory: pytest.TempPathFactory) -> Dissect:
    """Returns what the dissector of a vector's model knows and what it shows of the vector."""
    script = tmp_path_factory.mktemp("dissectors") / "vectors.lua"

    @functools.cache
    def dissector(model: str) -> tuple[DissectorView, Any]:
        path = VECTORS.parents[1] / model
        services = list(read_models([path]).model.instances(jaus.Service))
        view = DissectorView(SystemOfNothing(), path.name, services)
        runtime = lua54.LuaRuntime(encoding="latin-1")
        runtime.execute(STUB.read_text(encoding="ascii"))
        runtime.execute(write_dissector(script, view).read_text(encoding="ascii"))
        return view, runtime.globals().dissect

    def dissected(vector: dict[str, Any]) -> tuple[DissectorView, list[Shown]]:
        view, run = dissector(vector["model"])
        found = list(run(datagram(payload_of(vector) or b"").decode("latin-1")).values())
        pairs = zip(found[::2], found[1::2], strict=True)
        return view, [Shown(name, *3 * [utf8(str(value))]) for name, value in pairs]

    return dissected


@for_each("vector", DECODED, ids=lambda vector: vector["name"])
def test_the_dissector_shows_what_the_vector_says(dissect, vector):
    view, fields = dissect(vector)
    assert tells(view.messages, fields, vector)
