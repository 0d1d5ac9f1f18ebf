"""What is told of code of users is what Python does with it, however a model changes.

Each use of the generated interface is a module of its own. Importing it runs it: what raises must
be told as an error of that line, and what does not raise must not be told. The same holds after
all that is certain has been fixed.
"""

import importlib
import os
import re
import shutil
import sys
import traceback
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from generated import model_in
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from workspaces import packages_of

from jausml.generation.target import load_targets
from jausml.generation.workspace import generate
from jausml.language.model.diagnostics import Severity

GUARDS = ("jausml/generation/contract",)
EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "2"))
FOLDER = "boom/boom"
TARGETS = load_targets()
CODE = [TARGETS[name] for name in ("jaus_component", "messages")]


@dataclass(frozen=True)
class Message:
    """A message of the service: its names, each with what stays when it is renamed."""

    name: str
    code: int
    is_input: bool = True
    fields: tuple[str, ...] = ()
    values: tuple[tuple[str, int], ...] = ()

    def __str__(self) -> str:
        """Returns its text."""
        values = " ".join(f"enumerated_value {n} {{ value: {v} }}" for n, v in self.values)
        parts = [f"fixed_field State {{ values: {{ {values} }} }}"] if values else []
        parts += [
            f'fixed_field {field} {{ type: uint16 units: "m" scale: {{ lower: 0 upper: {size} }} }}'
            for size, field in enumerate(self.fields, 1)
        ]
        body = f"record R {{ {' '.join(parts)} }}" if parts else ""
        side = "inputs" if self.is_input else "outputs"
        command = "isCommand: true" if self.is_input and self.fields else ""
        return f"{side}: new message_def {self.name} {{ code: 0x{self.code:04X} {command} {body} }}"


BEFORE = (
    Message("FoldBoom", 0xD101, fields=("Speed", "Force")),
    Message("StopBoom", 0xD102, fields=("Delay",)),
    Message("QueryBoom", 0xD202),
    Message(
        "ReportBoom",
        0xD402,
        is_input=False,
        fields=("Height", "Width"),
        values=(("folded", 0), ("moving", 1), ("spread", 2)),
    ),
    Message("RejectBoom", 0xD403, is_input=False, values=(("busy", 0), ("stuck", 1))),
)


def model_of(folder: Path, messages: tuple[Message, ...]):
    text = f"""import `jaus.core-1.1`
service_set farm {{ service Boom {{
    urn: "urn:example:farm:Boom"
    inherits: Management
    {chr(10).join(map(str, messages))}
}} }}
system yard {{ component boom {{ address: 100.1.1  provides: Boom }} }}
"""
    return model_in(folder, text)


# --------------------------------------------------------------- how a model changes


def changed(messages: tuple[Message, ...], draw, number: int) -> tuple[Message, ...]:
    """Returns a model after one change, drawn from those that it can have."""
    index = draw(st.integers(0, len(messages) - 1))
    one = messages[index]
    ways = {
        "rename": [replace(one, name=f"Other{number}{one.name}")],
        "remove": [],
        "add": [one, Message(f"Added{number}Boom", 0xD500 + number, fields=("Length",))],
        "fields": [replace(one, fields=altered(one.fields, draw, f"Size{number}"))],
        "values": [replace(one, values=altered(one.values, draw, (f"v{number}", 50 + number)))],
    }
    way = draw(
        st.sampled_from([change for change in ways if change != "remove" or len(messages) > 1])
    )
    return (*messages[:index], *ways[way], *messages[index + 1 :])


def altered(things: tuple, draw, new):
    """Returns fields or values with one that is renamed, gone or new."""
    if not things:
        return things
    index = draw(st.integers(0, len(things) - 1))
    old = things[index]
    renamed = (new[0], old[1]) if isinstance(old, tuple) else new
    instead = draw(st.sampled_from([(renamed,), (), (old, new)]))
    kept = (*things[:index], *instead, *things[index + 1 :])
    return kept or things


# --------------------------------------------------------------- what a user writes


def uses(messages: tuple[Message, ...]) -> list[tuple[str, str]]:
    """Returns all names that a user can use: a class, and an expression with `{}` for it."""
    found = []
    for message in messages:
        snake = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", message.name).lower()
        found += [(message.name, "{}.CODE"), (message.name, "{}().encode()")]
        found += [("BoomBase", f"{{}}.on_{snake}")] if message.is_input and message.fields else []
        for name in map(str.lower, message.fields):
            found += [(message.name, f"{{}}().{name}"), (message.name, f"{{}}({name}=1.0)")]
        for name, _ in message.values:
            found += [
                (message.name, f"{{}}.State.{name.upper()}"),
                (message.name, f"{{}}.State[{name.upper()!r}]"),
                (message.name, f"{{}}(state={{}}.State.{name.upper()})"),
            ]
    return found


STYLES = (
    "from .{module} import {name}\n\n{use}\n",
    "from .{module} import {name} as Mine\n\n{use_mine}\n",
    "from . import {module} as m\n\n{use_module}\n",
    "import boom.{module}\n\n{use_whole}\n",
    "def f():\n    from boom.{module} import {name}\n\n    return {use}\n\n\nf()\n",
    "from boom.{module} import {name}\n\n\nclass C:\n    def g(self):\n        made = {use}\n"
    "        return made\n\n\nC().g()\n",
)


def written(style: str, name: str, use: str) -> str:
    module = "boom_base" if name == "BoomBase" else "messages"
    forms = {"use": name, "use_mine": "Mine", "use_module": f"m.{name}"}
    forms["use_whole"] = f"boom.{module}.{name}"
    return style.format(
        module=module, name=name, **{key: use.replace("{}", form) for key, form in forms.items()}
    )


# --------------------------------------------------------------- what Python says


@contextmanager
def only_from(out: Path):
    """Has the packages of a workspace imported from there, and forgets them after."""
    path, known = list(sys.path), set(sys.modules)
    sys.path[:0] = [str(package) for package in packages_of(out)]
    importlib.invalidate_caches()
    try:
        yield
    finally:
        sys.path[:] = path
        for name in set(sys.modules) - known:
            if name.partition(".")[0] in ("boom", "yard_messages"):
                del sys.modules[name]


def raised(out: Path, names: list[str]) -> dict[str, int]:
    """Returns the modules that raise when they are imported, with the line that does."""
    lines = {}
    with only_from(out):
        for name in names:
            try:
                importlib.import_module(f"boom.{name}")
            except (ImportError, AttributeError, TypeError, KeyError) as error:
                frames = traceback.extract_tb(error.__traceback__)
                lines[name] = [f.lineno for f in frames if Path(f.filename).stem == name][-1]
    return lines


def told(result, names) -> dict[str, int]:
    """Returns the modules of which errors are told, with the first line of each."""
    lines = {}
    for finding in result.drift:
        name = Path(finding.path).stem
        if name in names:
            assert finding.severity is Severity.ERROR, finding
            lines.setdefault(name, finding.line)
    return lines


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    """The workspace of the model before it changes."""
    out = tmp_path_factory.mktemp("farm") / "src"
    generate(model_of(out.parent, BEFORE), [*CODE, TARGETS["runtime"]], out)
    known = set(sys.modules)
    yield out
    # Its runtime, which all examples share, has no bridges: others need their own.
    for name in set(sys.modules) - known:
        if name.partition(".")[0] == "jausml_runtime":
            del sys.modules[name]


# What fails is small already: shrinking it would generate for minutes.
@settings(max_examples=EXAMPLES, phases=[Phase.generate])
@given(data=st.data())
def test_what_is_told_is_what_python_raises(workspace, tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("changed")
    out = folder / "src"
    shutil.copytree(workspace, out, copy_function=os.link)
    codes = {
        f"use_{number}": written(data.draw(st.sampled_from(STYLES)), *use)
        for number, use in enumerate(uses(BEFORE))
    }
    for name, text in codes.items():
        (out / FOLDER / f"{name}.py").write_text(text)
    assert raised(out, list(codes)) == {}
    messages = BEFORE
    for run in range(data.draw(st.integers(1, 2), "runs")):
        for number in range(data.draw(st.integers(run, 4), "changes")):
            messages = changed(messages, data.draw, 10 * run + number)
        result = generate(model_of(folder, messages), CODE, out, kept=None)
    assert told(result, codes) == raised(out, list(codes))
    fixed = generate(model_of(folder, messages), CODE, out, kept=None, fix=True)
    assert told(fixed, codes) == raised(out, list(codes))
    assert not [finding for finding in fixed.drift if finding.edits]
    edited = {Path(finding.path).stem for finding in result.drift if finding.edits}
    for name in codes.keys() - edited:
        assert (out / FOLDER / f"{name}.py").read_text() == codes[name]
