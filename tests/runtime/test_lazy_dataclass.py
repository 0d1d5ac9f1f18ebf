"""Dataclasses of generated messages against those of the standard library."""

from __future__ import annotations

import copy
import dataclasses
import importlib
import inspect
import pickle
import sys
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
from typing import ClassVar

import pytest

from jausml.runtime.wire import Message, dataclass


def written(decorator):
    """The same class under a decorator."""

    @decorator(slots=True)
    class Pose(Message):
        """A message as it is generated."""

        CODE: ClassVar[int] = 0xD001
        NAME: ClassVar[str] = "Pose"

        @decorator(slots=True)
        class Part:
            """A part of it."""

            value: int = 3

        x: float
        y: float | None = None
        parts: list[int] = dataclasses.field(default_factory=list)

        def norm(self) -> float:
            """A method of it."""
            return self.x**2

    return Pose


KINDS = {"lazy": dataclass, "standard": dataclasses.dataclass}


@pytest.fixture(params=list(KINDS))
def pose(request):
    """The class, of which nothing was asked yet."""
    return written(KINDS[request.param])


@dataclass(slots=True)
class Pickled:
    """A class that pickle finds."""

    x: int = 0


def test_it_is_made_by_position_and_by_name(pose):
    assert (pose(1.0).x, pose(1.0).y, pose(1.0).parts) == (1.0, None, [])
    assert pose(1.0, 2.0, [3]) == pose(parts=[3], y=2.0, x=1.0)
    assert pose(1.0).parts is not pose(1.0).parts
    assert pose(2.0).norm() == 4.0
    assert pose.Part().value == 3


def test_what_does_not_fit_is_refused_by_its_name(pose):
    with pytest.raises(TypeError, match=r"Pose\.__init__\(\) missing 1 required .* 'x'"):
        pose()
    with pytest.raises(TypeError, match=r"Pose\.__init__\(\) got an unexpected .* 'z'"):
        pose(1.0, z=2.0)
    with pytest.raises(AttributeError):
        pose(1.0).z = 2.0
    assert not hasattr(pose(1.0), "__dict__")


def test_it_is_compared_and_shown(pose):
    assert pose(1.0) == pose(1.0)
    assert pose(1.0) != pose(2.0)
    assert pose(1.0) != (1.0, None, [])
    assert repr(pose(1.0)) == "written.<locals>.Pose(x=1.0, y=None, parts=[])"
    with pytest.raises(TypeError, match="unhashable"):
        hash(pose(1.0))


def test_the_standard_library_takes_it_for_a_dataclass(pose):
    assert dataclasses.is_dataclass(pose)
    assert [(each.name, each.default) for each in dataclasses.fields(pose)][:2] == [
        ("x", dataclasses.MISSING),
        ("y", None),
    ]
    made = pose(1.0, parts=[1])
    assert dataclasses.replace(made, y=2.0) == pose(1.0, 2.0, [1])
    assert dataclasses.asdict(made) == {"x": 1.0, "y": None, "parts": [1]}
    assert copy.deepcopy(made) == made
    match made:
        case pose(x, y):
            assert (x, y) == (1.0, None)


def test_its_signature_is_that_of_its_fields(pose):
    assert list(inspect.signature(pose).parameters) == ["x", "y", "parts"]


def test_it_is_found_by_pickle():
    assert pickle.loads(pickle.dumps(Pickled(3))) == Pickled(3)  # noqa: S301


def test_classes_are_derived_from_it(pose):
    class Plain(pose):
        def __init__(self):
            super().__init__(5.0)

    @dataclasses.dataclass
    class More(pose):
        z: float = 9.0

    @dataclass(slots=True)
    class Slotted(pose):
        y: float | None = 7.0
        z: float = 8.0

    assert Plain().x == 5.0
    assert (Slotted.__slots__, Slotted.__match_args__) == (("z",), ("x", "y", "parts", "z"))
    assert repr(Slotted(1.0)).endswith("Slotted(x=1.0, y=7.0, parts=[], z=8.0)")
    assert Slotted(1.0) != pose(1.0, 7.0)
    assert (More(1.0, z=2.0).x, More(1.0).z) == (1.0, 9.0)


# ------------------------------------------------------------------ when it is made


@pytest.fixture
def completed(monkeypatch):
    """Names of the classes that the standard library made dataclasses of."""
    names = []

    def noted(cls):
        names.append(cls.__name__)
        return original(cls)

    original = dataclasses.dataclass
    monkeypatch.setattr(dataclasses, "dataclass", noted)
    return names


@pytest.mark.parametrize(
    "ask",
    [
        lambda cls: cls(1.0),
        dataclasses.fields,
        dataclasses.is_dataclass,
        inspect.signature,
        lambda cls: cls.__repr__,
    ],
)
def test_methods_are_made_once_when_they_are_needed(completed, ask):
    made = written(dataclass)
    assert completed == []
    ask(made)
    assert completed == ["Pose"]
    assert made(1.0) == made(1.0)
    assert completed == ["Pose"]


def test_threads_may_need_it_at_the_same_time():
    made, start = written(dataclass), Barrier(8)

    def make(number):
        start.wait()
        return made(float(number), parts=[number])

    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(make, range(8)))
    assert found == [made(float(number), None, [number]) for number in range(8)]
    assert [each.x for each in found] == [float(number) for number in range(8)]


def test_a_class_outlives_its_module(tmp_path, monkeypatch):
    (tmp_path / "module_that_goes.py").write_text(
        "from __future__ import annotations\n"
        "from typing import ClassVar\n"
        "from jausml.runtime.wire import dataclass\n"
        "@dataclass(slots=True)\n"
        "class Gone:\n"
        "    CODE: ClassVar[int] = 1\n"
        "    value: int = 2\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    gone = importlib.import_module("module_that_goes").Gone
    del sys.modules["module_that_goes"]
    assert gone(3) == gone(value=3)
    assert [each.name for each in dataclasses.fields(gone)] == ["value"]
    assert gone.__module__ == "module_that_goes"
