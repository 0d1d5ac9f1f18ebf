"""The generated codecs of every message of the library, fed with bodies that nobody meant.

The first two bytes of an input choose a message, the rest is its body.
"""

import importlib
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from jausml.generation.rendering import render
from jausml.generation.target import FileTask, Target
from jausml.language.metamodel.classes import jaus
from jausml.language.model import Model, read_models
from jausml.runtime.wire.message import DecodeError, EncodeError, Message
from jausml_generators.python.codec.examples import example_bytes
from jausml_generators.python.codec.message_builder import build_messages
from jausml_generators.python.codec.messages import MessagesModule, MessageView
from jausml_generators.python.package import PACKAGE_TEMPLATES

ROOT = Path(__file__).resolve().parents[3]
LIBRARY = sorted((ROOT / "models" / "library" / "jaus").glob("*.xmi"))
CHOICE = 2


class Codec(NamedTuple):
    """A message, and its class.

    Attributes:
        view: What the class was generated from.
        message: The class.
    """

    view: MessageView
    message: type[Message]


def codecs(module: str, views: tuple[MessageView, ...]) -> Target[None]:
    """Returns a target: one module with the messages of a service set.

    Args:
        module: Its name.
        views: The messages.
    """
    view = MessagesModule("Messages of the library.", "jausml.runtime", views)
    task = FileTask(
        "messages.py.j2",
        [view],
        lambda _: f"{module}.py",
        imports=lambda messages_module: messages_module.imports,
    )
    return Target(
        name="codecs",
        description="Codecs of a service set of the library.",
        tasks=lambda _: [task],
        template_folders=(PACKAGE_TEMPLATES,),
    )


def views_of(model: Model, path: Path) -> tuple[MessageView, ...]:
    """Returns the messages of the services of one file."""
    services = [s for s in model.instances(jaus.Service) if Path(model.location(s).path) == path]
    return build_messages(m for s in services for m in [*s.inputs, *s.outputs])


def generated(folder: Path) -> Iterator[Codec]:
    """Generates the codecs of the library into a folder and imports them.

    They are imported by name, so that a fuzzer that watches imports can see into them.
    """
    sys.path.insert(0, str(folder))
    for path in LIBRARY:
        views = views_of(read_models([path]).model, path)
        name = f"fuzzed_{path.stem.replace('-', '_').replace('.', '_')}"
        (artifact,) = render(None, [codecs(name, views)])
        (folder / artifact.path).write_text(artifact.text, encoding="utf-8")
        module = importlib.import_module(name)
        yield from (Codec(view, getattr(module, view.class_name)) for view in views)


with tempfile.TemporaryDirectory() as _folder:
    CODECS = tuple(generated(Path(_folder)))

OUTCOMES = dict.fromkeys(("refused", "taken but not sent", "sent again"), 0)


def one_input(data: bytes) -> None:
    """Takes one body.

    Raises:
        AssertionError: Something else than a refusal came of it, or a message that was taken does
            not survive the way out and in again.
    """
    index = int.from_bytes(data[:CHOICE], "little") % len(CODECS)
    message_class = CODECS[index].message
    payload = message_class.CODE.to_bytes(2, "little") + data[CHOICE:]
    try:
        message = message_class.decode(payload)
    except DecodeError:
        OUTCOMES["refused"] += 1
        return
    try:
        again = message.encode()
    except EncodeError:  # a value that the definition does not list
        OUTCOMES["taken but not sent"] += 1
        return
    OUTCOMES["sent again"] += 1
    decoded = message_class.decode(again)
    assert len(again) == len(payload), f"{message_class.NAME}: another size"
    assert decoded == message, f"{message_class.NAME}: other values"
    assert decoded.encode() == again, f"{message_class.NAME}: other bytes"


def seeds() -> list[bytes]:
    """Returns one body of each message, with every field present."""
    return [
        index.to_bytes(CHOICE, "little") + example_bytes(codec.view)[2:]
        for index, codec in enumerate(CODECS)
    ]


def report() -> str:
    """Returns what became of the bodies."""
    outcomes = ", ".join(f"{count} {outcome}" for outcome, count in OUTCOMES.items())
    return f"{len(CODECS)} messages: {outcomes}"
