"""A toy target over a toy model, and a workspace into which it generates."""

from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from jausml.generation.artifact import Kind, MethodContract, SkeletonContract
from jausml.generation.drift import drift
from jausml.generation.manifest import read_manifest
from jausml.generation.plan import make_plan
from jausml.generation.rendering import render as render_artifacts
from jausml.generation.target import FileTask, Target, TextFile, TextTask
from jausml.generation.writer import apply

TEMPLATES = {
    "base.py.j2": """\
{{ view.doc|docstring(0) }}

from __future__ import annotations


class {{ view.class_name|ident }}Base:
    {{ view.doc|docstring }}

    TITLE = {{ view.name|pystr }}
{% for message in view.messages %}

    def on_{{ message.name|ident }}(self, message: bytes) -> None:
        {{ ("Receives " ~ message.name ~ ".")|docstring(8) }}
{% endfor %}
""",
    "user.py.j2": '''\
"""Yours: written once."""

from .{{ view.name }}_base import {{ view.class_name }}Base


class {{ view.class_name }}({{ view.class_name }}Base):
    pass
''',
    "package.xml.j2": """\
<?xml version="1.0"?>
<!-- {{ view.doc|xmlcomment }} -->
<package name="{{ view.name|xml }}">{{ view.doc|xml }}</package>
""",
    "params.yaml.j2": """\
{{ view.doc|comment }}
{{ view.name }}:
  doc: {{ view.doc|yamlstr }}
""",
    "data.json.j2": '{"codes": {{ view.codes }}}\n',
}


@dataclass(frozen=True)
class Message:
    name: str
    code: int


@dataclass(frozen=True)
class Component:
    name: str
    messages: tuple[Message, ...] = ()
    doc: str = "A component."


@dataclass(frozen=True)
class ComponentView:
    component: Component
    source: str = "models/toy.xmi"

    @property
    def element_id(self):
        return f"component:{self.component.messages[0].code if self.component.messages else 0}"

    @property
    def name(self):
        return self.component.name

    @property
    def doc(self):
        return self.component.doc

    @property
    def messages(self):
        return self.component.messages

    @property
    def class_name(self):
        return self.component.name.title().replace("_", "")

    @property
    def codes(self):
        return [message.code for message in self.messages]

    @property
    def contract(self):
        methods = tuple(
            MethodContract(
                name=f"on_{message.name}",
                parameters=("message",),
                identity=f"0x{message.code:04x}",
                stub=f"def on_{message.name}(self, message: bytes) -> None: ...",
            )
            for message in self.messages
        )
        return SkeletonContract(self.class_name, f"{self.class_name}Base", methods)


def toy_tasks(model):
    views = [ComponentView(component) for component in model]
    return [
        FileTask("base.py.j2", views, lambda v: f"{v.name}/{v.name}_base.py"),
        FileTask(
            "user.py.j2",
            views,
            lambda v: f"{v.name}/{v.name}.py",
            kind=Kind.SKELETON,
            contract=lambda v: v.contract,
        ),
        FileTask("package.xml.j2", views, lambda v: f"{v.name}/package.xml"),
        FileTask("params.yaml.j2", views, lambda v: f"{v.name}/config/params.yaml"),
        FileTask("data.json.j2", views, lambda v: f"{v.name}/data.json"),
        TextTask(
            [TextFile(f"{v.name}/resource/{v.name}", "", v.element_id, v.source) for v in views]
        ),
    ]


def notes_tasks(model):
    return [
        TextTask(
            [
                TextFile(f"notes/{c.name}.md", f"# {c.name}\n", f"component:{c.name}", "toy")
                for c in model
            ]
        )
    ]


@dataclass
class Workspace:
    """An output folder and the targets that write there."""

    out: Path
    targets: list
    model: str = "toy"

    def render(self, model, targets=None):
        return render_artifacts(model, self.targets if targets is None else targets)

    def plan(self, model, targets=None, facts=None, **options):
        names = None if targets is None else {target.name for target in targets}
        manifest = read_manifest(self.out)
        artifacts = self.render(model, targets)
        return make_plan(
            artifacts,
            self.out,
            manifest,
            model=self.model,
            targets=names,
            model_facts=facts and (lambda _: facts),
            **options,
        )

    def write(self, model, targets=None, **options):
        plan = self.plan(model, targets, **options)
        apply(plan)
        return plan

    def drift(self, model):
        return drift(self.render(model), self.out, read_manifest(self.out))

    def snapshot(self):
        return {
            path.relative_to(self.out).as_posix(): (path.read_bytes(), path.stat().st_mtime_ns)
            for path in sorted(self.out.rglob("*"))
            if path.is_file()
        }

    def files(self):
        return {path: content for path, (content, _) in self.snapshot().items()}

    def path(self, relative):
        return self.out / relative


VEHICLE = Component("vehicle", (Message("set_speed", 0x0401), Message("report_pose", 0x4402)))
ARM = Component("arm", (Message("set_joint", 0x0601),))


@pytest.fixture
def templates(tmp_path):
    folder = tmp_path / "templates"
    folder.mkdir()
    for name, text in TEMPLATES.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def toy(templates):
    return Target("toy", "Toy packages.", toy_tasks, (templates,))


@pytest.fixture
def notes():
    return Target("notes", "One file for each component.", notes_tasks)


@pytest.fixture
def workspace(tmp_path, toy):
    return Workspace(tmp_path / "out", [toy])


@pytest.fixture
def vehicle():
    return VEHICLE


@pytest.fixture
def arm():
    return ARM


@pytest.fixture
def rename():
    """Changes fields of the frozen toy model."""
    return replace


@pytest.fixture
def make_message():
    return Message
