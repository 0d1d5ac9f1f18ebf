"""What pages ask for is typed while the program runs: a name that is not there fails at the ask."""

from inspect import signature
from types import SimpleNamespace
from typing import get_type_hints

from jausml.authoring.editing.project import Project
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.session import Session
from jausml.live.operating.seats import Seat


def test_types_of_what_the_studio_answers_are_there(tmp_path):
    context = StudioContext(Project(tmp_path))
    methods = Session(context)._answering._methods
    assert "recording.why" in methods
    for method in methods.values():
        signature(method.answer)
        get_type_hints(getattr(method.answer, "func", method.answer))


def test_types_of_what_an_operator_unit_answers_are_there():
    methods = Seat(SimpleNamespace(system=None), None, 1)._slow._methods
    assert "stick.move" in methods
    for method in methods.values():
        get_type_hints(method.answer)
