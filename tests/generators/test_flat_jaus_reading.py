"""Flat reading of JAUS messages, against their codecs."""

from __future__ import annotations

import functools
import itertools
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from codec_strategies import messages
from codec_support import codec, listed_definitions, load, read_messages, render
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from test_codecs import mutations

from jausml.runtime.bridge.messages.layouts import PresenceLayouts
from jausml.runtime.wire import DecodeError
from jausml_generators.bridge.flat.constants import Constants
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.jaus_reading import JausReading
from jausml_generators.python.codec.classes import BitFieldClass, ContainerClass, VariableFieldClass
from jausml_generators.python.codec.compounds import ArrayValue, ListValue, PartValue, VariantValue
from jausml_generators.python.codec.message_examples import example_bytes
from jausml_generators.python.codec.scalars import Bits
from jausml_generators.python.names import Scope

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from jausml_generators.python.codec.messages import MessageView

HERE = Path(__file__).parent
FEW = settings(
    max_examples=12, deadline=None, database=None, suppress_health_check=list(HealthCheck)
)
DEFINITIONS = listed_definitions()


# ------------------------------------------------------------------ what may be asked for


class Paths:
    """The paths into a message: single values, and lists with the paths into their elements."""

    def __init__(self, view: MessageView) -> None:
        self.view = view
        self.bits = {item.path: item for item in view.nested if isinstance(item, BitFieldClass)}
        self.values = list(dict.fromkeys(self._of(view.body, "")))
        self.lists = list(dict.fromkeys(self._lists(view.body, "")))

    def of_element(self, path: str) -> list[str]:
        """Returns the paths of an element of a list."""
        return list(dict.fromkeys(self._of(self._element(path), "")))

    def _element(self, path: str) -> Any:
        return next(v for p, v in self._all_lists(self.view.body, "") if p == path).element

    def _lists(self, part: Any, start: str) -> Iterator[str]:
        # Lists of options that share a name cannot be told apart.
        found = [path for path, _ in self._all_lists(part, start)]
        yield from (path for path in found if found.count(path) == 1)

    def _all_lists(self, part: Any, start: str) -> Iterator[tuple[str, Any]]:
        for member, path in self._members(part, start):
            if isinstance(member.value, (ListValue, ArrayValue)):
                yield path, member.value
            if isinstance(member.value, PartValue) and isinstance(
                member.value.part, ContainerClass
            ):
                yield from self._all_lists(member.value.part, path)
            if isinstance(member.value, VariantValue):
                for option in member.value.options:
                    yield from self._all_lists(option.part, path)

    @staticmethod
    def _members(part: Any, start: str) -> Iterator[tuple[Any, str]]:
        for member in getattr(part, "members", ()):
            yield member, f"{start}.{member.attribute}".lstrip(".")

    def _of(self, value: Any, path: str) -> Iterator[str]:  # noqa: C901 - a branch for each kind
        if isinstance(value, ContainerClass):
            for member, inner in self._members(value, path):
                if member.is_optional and isinstance(member.value, PartValue):
                    yield inner
                yield from self._of(member.value, inner)
        elif isinstance(value, PartValue):
            yield from self._of(value.part, path)
        elif isinstance(value, VariableFieldClass):
            yield from (f"{path}.index".lstrip("."), f"{path}.value".lstrip("."))
        elif isinstance(value, VariantValue):
            yield path or "."
            for option in value.options:
                yield from self._of(option.part, path)
        elif isinstance(value, (ListValue, ArrayValue)):
            count = value.count if isinstance(value, ArrayValue) else 2
            for index in range(min(count, 2)):
                yield from self._of(value.element, f"{path}[{index}]")
        else:
            yield path or "."
            if isinstance(value, Bits) and path:
                for sub in self.bits[value.python_type].sub_fields:
                    yield f"{path}.{sub.attribute}"


def value_at(found: Any, path: str) -> Any:
    """Returns what an object of the codec has at a path."""
    for step in path.replace("[", ".[").split(".") if path != "." else []:
        if found is None or step == "":
            return found
        if step.startswith("["):
            index = int(step[1:-1])
            found = found[index] if index < len(found) else None
        else:
            found = getattr(found, step, None)
    return found


def plain(found: Any, bits: dict[str, BitFieldClass]) -> Any:
    """Returns a value as flat code has it."""
    kinds = {path.rpartition(".")[2]: each for path, each in bits.items()}
    name = type(found).__name__
    if name in kinds:
        subs = kinds[name].sub_fields
        return {sub.attribute: getattr(found, sub.attribute) for sub in subs}
    if hasattr(found, "TAG"):
        return found.TAG
    return True if hasattr(found, "read_from") else found


def as_found(value: Any, expected: Any, cls: type) -> Any:
    """Returns a value of flat code as the codec has it, integers of bits as their parts."""
    if isinstance(expected, dict) and isinstance(value, int):
        for inner in vars(cls).values():
            names = getattr(inner, "__slots__", ())
            if tuple(names) == tuple(expected) and hasattr(inner, "from_integer"):
                made = inner.from_integer(value)
                return {name: getattr(made, name) for name in names}
        made = cls.TimeStamp.from_integer(value)  # type: ignore[attr-defined]
        return {name: getattr(made, name) for name in expected}
    return value


# ------------------------------------------------------------------ the code


def reader(
    view: MessageView, values: Iterable[str], lists: dict[str, list[str]]
) -> Callable[[bytes], dict[str, Any]]:
    """Returns a function that reads values, and rows of values of lists."""
    constants = Constants()
    reading = JausReading(view, constants, Scope(frozenset({"data", "found", "rows"})))
    names = {path: reading.value(path) for path in values}
    sequences = {path: reading.sequence(path) for path in lists}
    rows = {path: [sequences[path].element.value(inner) for inner in lists[path]] for path in lists}
    lines = ["found = {}"]
    lines += [f"found[{path!r}] = {name}" for path, name in names.items()]
    for path, sequence in sequences.items():
        row = f"rows.append(({''.join(name + ', ' for name in rows[path])}))"
        inner = ["rows = []", *sequence.loop([row]), f"found[{path!r}] = rows"]
        lines += [f"if {sequence.count} is None:", f"    found[{path!r}] = None", "else:"]
        lines += ["    " + line for line in inner]
    lines = [*reading.lines(), *lines]
    text = "\n".join(
        [
            *constants.lines,
            "def read(data):",
            *("    " + line for line in lines),
            "    return found",
        ]
    )
    space = {"struct": struct, "PresenceLayouts": PresenceLayouts, "DecodeError": DecodeError}
    exec(text, space)  # noqa: S102 - the code under test
    read: Callable[[bytes], dict[str, Any]] = space["read"]  # type: ignore[assignment]
    return read


@functools.cache
def readers(set_name: str, definition: str) -> tuple[Any, ...]:
    view, _ = codec(set_name, definition)
    return all_readers(view)


def all_readers(view: MessageView) -> tuple[Any, ...]:
    """Returns readers of everything, of every second value, and of nothing."""
    paths = Paths(view)
    lists = {path: paths.of_element(path) for path in paths.lists}
    some = {path: inner[1::2] for path, inner in itertools.islice(lists.items(), 1, None)}
    wanted: list[tuple[list[str], dict[str, list[str]]]] = [
        (paths.values, {}),
        ([], lists),
        (paths.values[::2], some),
        ([], {}),
    ]
    return tuple((values, inner, reader(view, values, inner)) for values, inner in wanted)


def check(view: MessageView, cls: Any, made: tuple[Any, ...], data: bytes) -> None:
    bits = Paths(view).bits
    try:
        message = cls.decode(data)
    except DecodeError:
        for _, _, read in made:
            with pytest.raises(DecodeError):
                read(data)
        return
    for values, lists, read in made:
        found = read(data)
        for path in values:
            expected = plain(value_at(message, path), bits)
            assert repr(as_found(found[path], expected, cls)) == repr(expected), path
        for path, inner in lists.items():
            elements = value_at(message, path)
            if elements is None:
                assert found[path] is None
                continue
            assert len(found[path]) == len(elements)
            for row, element in zip(found[path], elements, strict=True):
                wanted = [plain(value_at(element, each), bits) for each in inner]
                got = [as_found(v, w, cls) for v, w in zip(row, wanted, strict=True)]
                assert repr(got) == repr(wanted)


# ------------------------------------------------------------------ tests


@pytest.mark.parametrize(
    ("set_name", "definition"), DEFINITIONS, ids=["-".join(each) for each in DEFINITIONS]
)
def test_what_the_codec_reads_and_refuses(set_name: str, definition: str) -> None:
    view, cls = codec(set_name, definition)
    made = readers(set_name, definition)
    example = example_bytes(view)
    for end in range(2, len(example) + 1):
        check(view, cls, made, example[:end])
    check(view, cls, made, example + b"\0")

    @FEW
    @given(messages(view, cls), st.data())
    def differential(message: Any, more: st.DataObject) -> None:
        data = message.encode()
        check(view, cls, made, data)
        check(view, cls, made, more.draw(mutations(data)))

    differential()


@functools.cache
def modelled(file: str) -> tuple[dict[str, MessageView], Any]:
    views = read_messages(HERE / file)
    return {v.class_name: v for v in views}, load(render(views), f"flat_{Path(file).stem}")


EVERY = [
    (file, name)
    for file in ("hostile_messages.xmi", "every_kind.xmi")
    for name in modelled(file)[0]
]


@pytest.mark.parametrize(("file", "name"), EVERY)
def test_messages_of_every_kind_and_name(file: str, name: str) -> None:
    views, module = modelled(file)
    view, cls = views[name], getattr(module, name)
    made = all_readers(view)

    @FEW
    @given(messages(view, cls), st.data())
    def differential(message: Any, more: st.DataObject) -> None:
        data = message.encode()
        check(view, cls, made, data)
        check(view, cls, made, more.draw(mutations(data)))

    differential()


def test_one_unpack_for_a_message_of_fields_of_fixed_size() -> None:
    view, _ = codec("mobility", "VelocityStateSensor.ReportVelocityState")
    constants = Constants()
    reading = JausReading(view, constants, Scope(frozenset({"data"})))
    assert reading.value("velocity_x") == "velocity_x"
    assert reading.lines()[:2] == [
        "try:",
        "    presence, velocity_x = _LAYOUTS_1[data[2:4]].unpack(data)",
    ]
    assert len(constants.lines) == 1


def test_paths_that_lead_nowhere_are_refused() -> None:
    view, _ = codec("mobility", "ListManager.SetElement")
    reading = JausReading(view, Constants(), Scope())
    for path in ("speed", "element_list", "request_id_rec[0]", "request_id_rec.request_id.x"):
        with pytest.raises(NotFlatError):
            reading.value(path)
    with pytest.raises(NotFlatError):
        reading.sequence("request_id_rec")


def test_layouts_are_kept_within_bounds() -> None:
    fields = [(1 << bit, "B") for bit in range(16)]
    layouts = PresenceLayouts("Report", 0xFFFF, 2, (0, "H"), *fields)
    for presence in range(2000):
        layout = layouts[presence.to_bytes(2, "little")]
        assert layout.size == 2 + presence.bit_count()
    assert len(layouts) <= 256
