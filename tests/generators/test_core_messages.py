"""The runtime's own messages are what the library says, and what generators would write."""

import random
import sys
import types
from collections.abc import Iterator
from dataclasses import asdict, fields, is_dataclass
from enum import IntEnum
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from codec_support import library
from for_each import for_each

from jausml.generation.rendering import render
from jausml.generation.target import FileTask, Target, Task
from jausml.language.metamodel.classes import jaus
from jausml.language.model import Model, read_models
from jausml.language.semantics.jaus.core_services import (
    CORE,
    CORE_MESSAGES,
    HANDOFF,
    SERVED_BY_RUNTIME,
)
from jausml.runtime import messages as core_messages
from jausml.runtime.component.component import JausComponent
from jausml.runtime.services.liveness import UNSOLICITED
from jausml.runtime.wire import DecodeError, EncodeError, Message
from jausml_generators.python.codec.message_builder import build_messages
from jausml_generators.python.codec.messages import MessagesModule
from jausml_generators.python.package import PACKAGE_TEMPLATES

LIBRARY = Path(__file__).parents[2] / "models" / "library" / "jaus"
SOURCE = LIBRARY / "core-1.1.xmi"
TOO_MUCH = (
    -1, 2**8, 2**16, 2**32, 1e9, -0.5, "x" * 300, "\u20ac", b"", b"x", None, 5.0, float("nan"),
)  # fmt: skip

GUARDS = (
    "models/library/jaus",
    "jausml/runtime/messages",
    "jausml/runtime/wire/codec.py",
    "jausml/runtime/wire/layout.py",
)


def tasks(model: Model) -> list[Task]:
    services = [
        service
        for service in model.instances(jaus.Service)
        if service.urn in HANDOFF or str(service.urn).startswith(CORE)
    ]
    messages = [output for one in services for output in [*one.inputs, *one.outputs]]
    module = MessagesModule(
        summary="The messages of the core services.",
        runtime="jausml.runtime",
        messages=build_messages(messages),
        source=SOURCE.name,
        element_id="core_messages",
    )
    imports = lambda messages_module: messages_module.imports  # noqa: E731
    return [FileTask("messages.py.j2", [module], lambda _: "core.py", imports=imports)]


@pytest.fixture(scope="module")
def generated() -> Iterator[types.ModuleType]:
    """What the generator makes of the library."""
    target = Target(
        name="core_messages", description="", tasks=tasks, template_folders=(PACKAGE_TEMPLATES,)
    )
    (artifact,) = render(read_models([LIBRARY / "iop.xmi"]).model, [target])
    module = types.ModuleType("generated_core_messages")
    sys.modules[module.__name__] = module
    exec(artifact.text, vars(module))  # noqa: S102
    yield module
    del sys.modules[module.__name__]


def classes(module: types.ModuleType) -> dict[str, type[Message]]:
    return {
        name: value
        for name, value in vars(module).items()
        if isinstance(value, type) and issubclass(value, Message) and hasattr(value, "CODE")
    }


NAMES = sorted(classes(core_messages))


def parts_of(cls: type) -> dict[str, Any]:
    """Classes that a message offers, those of its bases included."""
    found = {name: getattr(cls, name) for name in dir(cls) if name[0] != "_"}
    return {name: part for name, part in found.items() if isinstance(part, type)}


def filled(draw: random.Random, cls: Any, kinds: dict[str, Any], text: str) -> Any:
    """An object of a generated class with values that are mostly legal."""

    def value(declared: str, default: Any) -> Any:
        if declared.endswith(" | None"):
            return None if draw.random() < 0.3 else value(declared[:-7], default)
        if declared.startswith(("list[", "MutableSequence[")):
            count = draw.choice((0, 1, 3))
            element = declared.partition("[")[2].removesuffix("]")
            return [value(element, default) for _ in range(count)]
        if "." in declared:
            kind = kinds[declared.rsplit(".", maxsplit=1)[-1]]
            options = getattr(kind, "__args__", (kind,))
            return filled(draw, draw.choice(options), kinds, text)
        if declared == "int":
            return (
                default if isinstance(default, int) and draw.random() < 0.3 else draw.choice(LEGAL)
            )
        return {"float": draw.uniform(0, 1092), "bytes": text.encode(), "str": text}[declared]

    return cls(**{field.name: value(field.type, field.default) for field in fields(cls)})


LEGAL = (0, 1, 1, 2, 3, 5, 6, 12, 31, 200, 255, 10001)


def moved(value: Any, module: types.ModuleType, cls: Any) -> Any:
    """The same value as an object of the classes of another module."""
    if isinstance(value, list):
        return [moved(element, module, cls) for element in value]
    if not is_dataclass(value):
        return value
    name = type(value).__name__
    kind = cls if name == cls.__name__ else getattr(cls, name)
    return kind(
        **{field.name: moved(getattr(value, field.name), module, cls) for field in fields(value)}
    )


def outcome(action: Any) -> Any:
    try:
        return action()
    except EncodeError as error:
        return type(error), error.field, error.reason
    except DecodeError as error:
        # How many bytes are read at once is up to each codec.
        return type(error), error.where, error.reason.split(": unpack_from")[0]


def spoilt(draw: random.Random, message: Any) -> None:
    """Gives one field, at any depth, a value that may not fit."""
    at = message
    while True:
        field = draw.choice(fields(at))
        inner = getattr(at, field.name)
        inner = draw.choice(inner) if isinstance(inner, list) and inner else inner
        if not is_dataclass(inner):
            setattr(at, field.name, draw.choice(TOO_MUCH))
            return
        at = inner


@for_each("name", NAMES)
def test_a_message_offers_what_a_generated_one_does(name, generated):
    cls, other = getattr(core_messages, name), getattr(generated, name)
    assert (cls.CODE, cls.NAME) == (other.CODE, other.NAME)
    assert [field.name for field in fields(cls)] == [field.name for field in fields(other)]
    assert asdict(cls()) == asdict(other())
    assert not hasattr(cls(), "__dict__")
    offered = parts_of(cls)
    for inner, kind in parts_of(other).items():
        if issubclass(kind, IntEnum):
            assert {e.name: e.value for e in offered[inner]} == {e.name: e.value for e in kind}
        else:
            assert asdict(offered[inner]()) == asdict(kind())
            assert getattr(offered[inner], "TAG", None) == getattr(kind, "TAG", None)


@for_each("name", NAMES)
def test_a_message_is_written_and_read_as_a_generated_one(name, generated):
    cls, other = getattr(core_messages, name), getattr(generated, name)
    kinds = {key: getattr(other, key) for key in dir(other) if key[0] != "_"}
    draw = random.Random(name)
    written = 0
    for number in range(120):
        example = filled(draw, other, kinds, draw.choice(("", "ab", "abcd\0", "\xe4" * 80)))
        if number % 2 and fields(other):
            spoilt(draw, example)
        same = moved(example, core_messages, cls)
        expected = outcome(example.encode)
        assert outcome(same.encode) == expected, example
        if not isinstance(expected, bytes):
            continue
        written += 1
        data = bytearray(expected)
        for _ in range(8):
            read, wanted = (outcome(partial(c.decode, bytes(data))) for c in (cls, other))
            if isinstance(wanted, Message):
                read, wanted = asdict(read), asdict(wanted)
                assert str(read) == str(wanted)
            else:
                assert read == wanted
            cut = draw.randrange(len(data) + 1)
            data = draw.choice(
                (
                    data[:cut],
                    data + b"\x01",
                    data[:cut] + bytes([draw.randrange(256)]) + data[cut + 1 :],
                )
            )
    assert written >= 5


def test_the_module_has_every_message_of_the_core_services():
    views, _, _ = library("core-v1.1")
    model = read_models([LIBRARY / "iop.xmi"]).model
    handoff = [service for service in model.instances(jaus.Service) if service.urn in HANDOFF]
    views += build_messages([m for service in handoff for m in [*service.inputs, *service.outputs]])
    expected = {view.jaus_name: view.code for view in views}
    found = {name: cls.CODE for name, cls in classes(core_messages).items()}
    assert found == expected == CORE_MESSAGES


def test_messages_of_core_1_0_are_the_same():
    newer = {view.jaus_name: view for view in library("core-v1.1")[0]}
    for view in library("core-v1.0")[0]:
        assert view.body.segments == newer[view.jaus_name].body.segments
        assert view.code == newer[view.jaus_name].code


def test_models_and_runtime_agree_on_the_services_that_the_runtime_serves():
    classes: Any = JausComponent.core_services
    served = frozenset().union(*(service_class.urns for service_class in classes))
    # Transport has no messages; unsolicited heartbeats are a setting of Liveness, and handoffs are
    # decided by clients.
    others = {CORE + "Transport", UNSOLICITED, "urn:jaus:jss:iop:HandoffController"}
    assert served | others == SERVED_BY_RUNTIME


def test_a_presence_vector_with_bits_of_no_field_is_refused():
    with pytest.raises(DecodeError, match="SetTime: unknown bits in presence vector 0x4"):
        core_messages.SetTime.decode(b"\x11\x00\x04")
