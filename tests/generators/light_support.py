"""Light classes of all types of the library, values for them, and an own writer of CDR."""

import functools
import importlib
import struct
import sys
import types
from dataclasses import dataclass
from pathlib import Path

from generated import model_of
from hypothesis import strategies as st

from jausml.generation.rendering import render
from jausml.generation.target import FileTask, Target, templates_beside
from jausml.language.cdr import fields_of
from jausml.language.metamodel.classes import ros
from jausml_generators.bridge import target as bridge_target
from jausml_generators.bridge.light_module import LightModule
from jausml_generators.common.ros import ros_type

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = sorted((ROOT / "models" / "library" / "ros").glob("*.xmi"))
EXTREMES = Path(__file__).with_name("extreme_types.xmi")


@dataclass(frozen=True)
class ModuleView:
    """What the template asks of a bridge."""

    light: LightModule
    title: str = "library"
    element_id: str = "library"
    source: str = "library"


@dataclass(frozen=True)
class Made:
    """A module of light classes.

    Attributes:
        module: The module.
        types: The types of the model by name.
        light: The view that it was made from.
        text: Its text as it is generated.
    """

    module: types.ModuleType
    types: dict[str, ros.MessageType]
    light: LightModule
    text: str

    def kind(self, name):
        """Returns the class of a type."""
        return self.class_of(self.types[name])

    def class_of(self, message):
        return getattr(self.module, self.light.name_of(message))

    def object(self, name, values):
        """Returns values as an object of a light class."""
        return _object(self.types[name], values, self.class_of, is_real=False)


def light_module(paths, name):
    """Returns the module of the light classes of all message types in some files."""
    model = model_of(*paths)
    packages = list(model.instances(ros.InterfacePackage))
    light = LightModule([message for package in packages for message in package.messages])
    target = Target(
        "light",
        "",
        lambda _model: [
            FileTask(
                "ros_types.py.j2",
                [ModuleView(light)],
                lambda _view: "ros_types.py",
                imports=lambda view: view.light.imports,
            )
        ],
        (templates_beside(bridge_target.__file__),),
    )
    [artifact] = render(model, [target])
    module = types.ModuleType(name)
    text = artifact.text.replace("from jausml_runtime.", "from jausml.runtime.")
    sys.modules[name] = module
    exec(compile(text, name, "exec"), vars(module))  # noqa: S102
    return Made(
        module,
        {ros_type(message_type).full_name: message_type for message_type in light.types},
        light,
        artifact.text,
    )


@functools.cache
def library():
    """Returns the light classes of the library."""
    return light_module(LIBRARY, "light_library")


@functools.cache
def extremes():
    """Returns the light classes of types that no installed package has."""
    return light_module([EXTREMES], "light_extremes")


def real_class(message):
    """Returns the installed class of a type, None without one."""
    kind = ros_type(message)
    try:
        return getattr(importlib.import_module(kind.module), kind.name)
    except (ImportError, AttributeError):
        return None


# ------------------------------------------------------------------ values


@functools.cache
def values_of(message):
    """Returns a strategy for the values of a message, as dict by field."""
    return st.fixed_dictionaries({field.name: _field(field) for field in fields_of(message)})


def _field(field):
    one = _one(field)
    if field.is_single:
        return one
    if field.is_fixed:
        # Long arrays of all the same: their elements are tried by the short ones.
        if field.count > 40:
            return one.map(lambda value: [value] * field.count)
        return st.lists(one, min_size=field.count, max_size=field.count)
    return st.lists(one, max_size=min(field.count, 4) if field.is_bounded else 4)


def _one(field):
    if field.message is not None:
        return values_of(field.message)
    if field.primitive is None:
        most = {"max_size": min(field.bound, 9) if field.bound else 9}
        safe = st.characters(exclude_characters="\0", exclude_categories=["Cs"])
        if field.text == "wstring":
            safe = st.characters(
                exclude_characters="\0", exclude_categories=["Cs"], max_codepoint=0xFFFF
            )
        return st.text(safe, **most)
    code = field.primitive.code
    if code == "?":
        return st.booleans()
    if code in "fd":
        return st.floats(width=32 if code == "f" else 64, allow_nan=False)
    bits = 8 * field.primitive.size
    low = -(2 ** (bits - 1)) if code.islower() else 0
    return st.integers(low, low + 2**bits - 1)


def real_object(message, values):
    """Returns values as an object of an installed class."""
    return _object(message, values, real_class, is_real=True)


def _object(message, values, class_of, *, is_real):
    def one(field, value):
        if field.message is not None:
            return _object(field.message, value, class_of, is_real=is_real)
        is_byte = field.primitive is not None and field.primitive.idl == "octet"
        return bytes([value]) if is_real and is_byte else value

    made = class_of(message)()
    for field in fields_of(message):
        value = values[field.name]
        value = one(field, value) if field.is_single else [one(field, entry) for entry in value]
        setattr(made, field.name, value)
    return made


# ------------------------------------------------------------------ an own writer


class Writer:
    """Writes values as CDR in either byte order, and notes which bytes are padding."""

    def __init__(self, mark):
        self.data = bytearray(b"\0\1\0\0" if mark == "<" else b"\0\0\0\0")
        self.padding = set()
        self._mark = mark

    def number(self, code, value):
        size = struct.calcsize(f"={code}")
        while (len(self.data) - 4) % size:
            self.padding.add(len(self.data))
            self.data.append(0)
        self.data += struct.pack(self._mark + code, value)

    def message(self, message, values):
        fields = fields_of(message)
        if not fields:
            self.padding.add(len(self.data))
            self.data.append(0)
        for field in fields:
            value = values[field.name]
            if not (field.is_single or field.is_fixed):
                self.number("I", len(value))
            for entry in [value] if field.is_single else value:
                self._one(field, entry)

    def _one(self, field, value):
        if field.message is not None:
            self.message(field.message, value)
        elif field.primitive is not None:
            self.number(field.primitive.code, value)
        elif field.text == "string":
            raw = value.encode() + b"\0"
            self.number("I", len(raw))
            self.data += raw
        else:
            units = memoryview(value.encode("utf-16-le")).cast("H")
            self.number("I", len(units))
            for unit in units:
                self.number("I", unit)


def written(message, values, mark="<"):
    """Returns values as CDR, and the places of padding."""
    writer = Writer(mark)
    writer.message(message, values)
    return bytes(writer.data), writer.padding


def masked(data, padding, length):
    """Returns serialized data with zeros where nobody says what stands."""
    return bytes(0 if i in padding else byte for i, byte in enumerate(data[:length]))
