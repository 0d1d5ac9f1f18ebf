"""Codecs generated from the library, and their objects in the shape of the golden vectors."""

import functools
import importlib.util
import sys
import tempfile
from pathlib import Path
from types import ModuleType
from typing import Any

from generated import model_of
from lxml import etree

from jausml.generation.rendering import render as render_targets
from jausml.generation.target import FileTask, Target
from jausml.language.metamodel.classes import jaus
from jausml_generators.python.codec.classes import BitFieldClass, ContainerClass
from jausml_generators.python.codec.message_builder import build_message_map
from jausml_generators.python.codec.messages import MessagesModule, MessageView
from jausml_generators.python.codec.scalars import Tag

ROOT = Path(__file__).resolve().parents[2]
TEMPLATES = ROOT / "generators" / "jausml_generators" / "python" / "templates"
LIBRARY = ROOT / "models" / "library" / "jaus"
LIBRARY_FILES = {
    "core-v1.0": "core-1.0.xmi", "core-v1.1": "core-1.1.xmi", "mobility": "mobility.xmi",
    "environmentSensing": "environment-sensing.xmi", "manipulator": "manipulator-1.0.xmi",
    "manipulator-v2.0": "manipulator-2.0.xmi", "ugv": "ugv.xmi", "iop": "iop.xmi",
}  # fmt: skip


def render(messages: tuple[MessageView, ...], summary: str = "Messages of a test.") -> str:
    """Returns the text of a module with the codecs."""
    view = MessagesModule(summary, "jausml.runtime", messages, "test.xmi", "test")
    task = FileTask(
        "messages.py.j2",
        [view],
        lambda _: "messages.py",
        imports=lambda messages_module: messages_module.imports,
    )
    target = Target("messages", "", lambda _: [task], template_folders=(TEMPLATES,))
    (artifact,) = render_targets(None, [target])
    return artifact.text


def load(text: str, name: str) -> ModuleType:
    """Imports a generated text as a module."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.py"
        path.write_text(text, encoding="utf-8")
        spec = importlib.util.spec_from_file_location(name, path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
    return module


def read_messages(path: Path) -> tuple[MessageView, ...]:
    """Returns the views of all messages of a file's services."""
    return tuple(dict.fromkeys(_read(path).values()))


def _read(path: Path) -> dict[str, MessageView]:
    model = model_of(path)
    services = [s for s in model.instances(jaus.Service) if Path(model.location(s).path) == path]
    found = build_message_map(m for s in services for m in [*s.inputs, *s.outputs])
    return {f"{element.eContainer().name}.{element.name}": v for element, v in found.items()}


@functools.cache
def definitions(set_name: str) -> dict[str, MessageView]:
    """Returns the views of all definitions of a set by service and message.

    Several services of a set define some messages; equal definitions share a view.
    """
    return _read(LIBRARY / LIBRARY_FILES[set_name])


@functools.cache
def library(set_name: str) -> tuple[tuple[MessageView, ...], str, ModuleType]:
    """Returns views, text and module of the messages of a service set of the library."""
    views = tuple(dict.fromkeys(definitions(set_name).values()))
    text = render(views)
    return views, text, load(text, f"generated_{set_name.replace('-', '_').replace('.', '_')}")


def codec(set_name: str, definition: str) -> tuple[MessageView, Any]:
    """Returns view and class of one definition."""
    view = definitions(set_name)[definition]
    return view, getattr(library(set_name)[2], view.class_name)


def listed_definitions() -> list[tuple[str, str]]:
    """Returns set and definition of every message of the library, as its files list them.

    The files are read as mere XML, so that a message which the reader or the builder loses is
    missed by the tests.
    """
    found = []
    for set_name in shipped_sets():
        root = etree.parse(LIBRARY / LIBRARY_FILES[set_name]).getroot()
        for service in root.iter("services"):
            messages = [*service.iterchildren("inputs"), *service.iterchildren("outputs")]
            found += [(set_name, f"{service.get('name')}.{m.get('name')}") for m in messages]
    return found


def shipped_sets() -> list[str]:
    """Returns the names of the service sets that the library ships."""
    return [name for name, file in LIBRARY_FILES.items() if (LIBRARY / file).exists()]


class FieldNames:
    """Objects of the classes of a message, and the JSIDL names that the golden vectors use."""

    def __init__(self, view: MessageView, module: ModuleType) -> None:
        self.view = view
        self.cls = getattr(module, view.class_name)
        self.bits = {item.path: item for item in view.nested if isinstance(item, BitFieldClass)}
        self.body_name = view.body.jaus_name
        self.is_flat = bool(self.body_name) and not view.body.is_wrapper

    def to_fields(self, message: Any) -> dict[str, Any]:
        """Returns a message in the shape of the golden vectors."""
        if not self.body_name:
            return {}
        values = self._part_to_fields(self.view.body, message)
        return {self.body_name: values} if self.is_flat else values

    def from_fields(self, fields: dict[str, Any]) -> Any:
        """Returns the message that the fields of a golden vector describe."""
        if not self.body_name:
            return self.cls()
        inner = fields[self.body_name] if self.is_flat else fields
        return self._part_from_fields(self.view.body, self.cls, inner)

    def _part_to_fields(self, part: ContainerClass, obj: Any) -> dict[str, Any]:
        values = {member.jaus_name: getattr(obj, member.attribute) for member in part.members}
        fields: dict[str, Any] = {}
        if part.presence_struct:
            fields["_pv"] = sum(m.bit for m in part.members if values[m.jaus_name] is not None)
        for member in part.members:
            if values[member.jaus_name] is not None:
                fields[member.jaus_name] = self._to_field(member.value, values[member.jaus_name])
        return fields

    def _to_field(self, value: Any, obj: Any) -> Any:
        if value.kind in ("list", "array"):
            return [self._to_field(value.element, item) for item in obj]
        if value.kind == "variant":
            option = value.options[obj.TAG].part
            inner = self._part_to_fields(option, obj)
            return {"_tag": obj.TAG, **(inner if option.is_wrapper else {option.jaus_name: inner})}
        if value.kind == "part":
            return self._nested_to_field(value.part, obj)
        if value.kind == "blob" and not value.is_text:
            return {"hex": obj.hex()}
        if value.python_type in self.bits:
            subs = self.bits[value.python_type].sub_fields
            return {sub.jaus_name: getattr(obj, sub.attribute) for sub in subs}
        return {"_tag": obj} if isinstance(value, Tag) else obj

    def _nested_to_field(self, part: Any, obj: Any) -> Any:
        if part.kind == "variable_field":
            return {"index": obj.index, "value": obj.value}
        if [member.jaus_name for member in part.members] == ["format", "hex"]:
            return {"format": obj.format_index, "hex": obj.data.hex()}
        fields = self._part_to_fields(part, obj)
        return fields[part.members[0].jaus_name] if part.is_wrapper else fields

    def _part_from_fields(self, part: ContainerClass, cls: Any, fields: Any) -> Any:
        arguments = {
            member.attribute: self._from_field(member.value, fields[member.jaus_name])
            for member in part.members
            if member.jaus_name in fields
        }
        return cls(**arguments)

    def _class(self, path: str) -> Any:
        return getattr(self.cls, path.rpartition(".")[2])

    def _from_field(self, value: Any, field: Any) -> Any:
        if value.kind in ("list", "array"):
            return [self._from_field(value.element, item) for item in field]
        if value.kind == "variant":
            option = value.options[field["_tag"]].part
            inner = field if option.is_wrapper else field[option.jaus_name]
            return self._part_from_fields(option, self._class(option.path), inner)
        if value.kind == "part":
            cls = self._class(value.part.path)
            if set(field) in ({"format", "hex"}, {"index", "value"}):
                first, second = field.values()
                return cls(first, bytes.fromhex(second) if "hex" in field else second)
            if value.part.is_wrapper:
                field = {value.part.members[0].jaus_name: field}
            return self._part_from_fields(value.part, cls, field)
        if value.kind == "blob" and not value.is_text:
            return bytes.fromhex(field["hex"])
        if value.python_type in self.bits:
            subs = self.bits[value.python_type].sub_fields
            numbers = {sub.attribute: field[sub.jaus_name] for sub in subs}
            return self._class(value.python_type)(**numbers)
        return field["_tag"] if isinstance(field, dict) else field
