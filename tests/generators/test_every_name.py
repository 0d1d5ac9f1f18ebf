"""A name that generated code uses itself may stand anywhere in a model, in every target."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import MutableSequence, Sequence
from typing import TYPE_CHECKING, Any, get_args, get_origin, get_type_hints

import needs
import pytest
from lupa import lua54
from workspaces import python_path, write

from jausml.generation.native import compiler
from jausml.generation.python.modules import STANDARD
from jausml.language.interfaces import parse_definition
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.codec_cpp.target import TARGET as CODEC_CPP
from jausml_generators.jaus_component.target import TARGET as COMPONENT
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.python.names import WIRE
from jausml_generators.python.package import runtime_names
from jausml_generators.ros_interfaces.target import TARGET as ROS_INTERFACES
from jausml_generators.runtime.target import TARGET as RUNTIME
from jausml_generators.wireshark.target import TARGET as WIRESHARK

from .codec_support import load, read_messages, render

if TYPE_CHECKING:
    from pathlib import Path
    from types import ModuleType


MESSAGE = """
    <outputs name="{message}" code="{code:#06x}">
      <body xsi:type="jaus:Sequence" name="Body">
        <fields xsi:type="jaus:Record" name="First{number}" presenceVector="uint8">
          <fields xsi:type="jaus:FixedField" name="{name}" type="uint8">
            <values><values xsi:type="jaus:EnumeratedValue" name="{name}" value="0"/></values>
          </fields>
          <fields xsi:type="jaus:FixedField" name="Scaled" type="uint16" optional="true">
            <scale lower="-1" upper="1"/>
          </fields>
          <fields xsi:type="jaus:VariableLengthString" name="Text"/>
        </fields>
        <fields xsi:type="jaus:Record" name="{name}">
          <fields xsi:type="jaus:FixedField" name="Real" type="float64"/>
          <fields xsi:type="jaus:BitField" name="{name}" type="uint8">
            <subFields name="{name}" lowBit="0" highBit="3"/>
            <subFields name="Last" lowBit="4" highBit="7"/>
          </fields>
        </fields>
        <fields xsi:type="jaus:List" name="{name}s">
          <element xsi:type="jaus:Record" name="{name}">
            <fields xsi:type="jaus:FixedField" name="{name}" type="uint32"/>
            <fields xsi:type="jaus:FixedField" name="Other" type="float32"/>
          </element>
        </fields>
        <fields xsi:type="jaus:List" name="Row{number}s">
          <element xsi:type="jaus:Record" name="Row{number}">
            <fields xsi:type="jaus:FixedField" name="{name}" type="uint32"/>
          </element>
        </fields>
        <fields xsi:type="jaus:Variant" name="{name}">
          <options xsi:type="jaus:Record" name="{name}">
            <fields xsi:type="jaus:FixedField" name="{name}" type="int8"/>
          </options>
        </fields>
      </body>
    </outputs>
"""
MODEL = """<?xml version="1.0" encoding="UTF-8"?>
<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:jaus="http://www.jausml.org/jaus/1.0" name="names">
  <services name="Names" urn="urn:names:Names">{messages}</services>
</jaus:ServiceSet>
"""


def model(path: Path, names: Sequence[str], message: str = "Report{number}") -> Path:
    """Writes a service with a message for each name, which has it wherever a name may stand."""
    messages = (
        MESSAGE.format(
            message=message.format(number=number, name=name),
            number=number,
            code=0xD100 + number,
            name=name,
        )
        for number, name in enumerate(names)
    )
    path.write_text(MODEL.format(messages="".join(messages)))
    return path


def names_used(folder: Path) -> list[str]:
    """Returns the names in a module of messages: imported, called, defined and assigned ones."""
    found = {*WIRE, *STANDARD}
    text = render(read_messages(model(folder / "plain.xmi", ("Plain",))))
    for node in ast.walk(ast.parse(text)):
        for part in ("id", "name", "arg", "attr"):
            found.add(getattr(node, part, None) or "")
    return sorted(each for each in found if each.isidentifier() and "lain" not in each)


def filled(message: Any, module: ModuleType) -> Any:
    """Returns a message with an element in each of its lists."""
    known = {**vars(module), "MutableSequence": MutableSequence}
    hints = get_type_hints(type(message), known)
    for name, hint in hints.items():
        if get_origin(hint) is MutableSequence:
            (element,) = get_args(hint)
            getattr(message, name).append(element())
    return message


def test_names_of_generated_python_may_stand_in_messages(tmp_path: Path) -> None:
    names = names_used(tmp_path)
    assert {"Number", "RowLayout", "read_records", "offset", "CODE", "DecodeError"} <= {*names}
    module = load(render(read_messages(model(tmp_path / "names.xmi", tuple(names)))), "every_name")
    for number, name in enumerate(names):
        message = filled(getattr(module, f"Report{number}")(), module)
        assert type(message).decode(message.encode()) == message, name


OF_CPP = """
    alignas and asm auto bitand bool break case catch char class compl const constexpr continue
    decltype default delete do double else enum explicit export extern false float for friend goto
    if inline int long mutable namespace new noexcept not nullptr operator or private protected
    public register return short signed sizeof static struct switch template this throw true try
    typedef typeid typename union unsigned using virtual void volatile wchar_t while xor std jaus
    final override
"""
OF_LUA = "end elseif function local nil repeat then until tree at read"
OF_ROS = "string wstring byte time duration uint8 Time Duration MIN MAX PRESENCE header"

SYSTEM = """
import "names.xmi"
component unit {{ address: 1.1.1  provides: Names }}
bridge front {{ address: 1.1.2  uses: Names
{connections}
}}
{maps}
"""


def system(folder: Path, names: Sequence[str]) -> str:
    """Returns a component and a bridge that have a message of each name."""
    connections = (
        f"connection c{number} {{ map: m{number}  direction: rosToJaus  exchange: message"
        f"  peers: unit  control: false  topic t{number} {{ }} }}"
        for number in range(len(names))
    )
    maps = (
        f"m{number} {{ JAUS `{name}`  ROS std_msgs/Float64"
        f"  ROS->JAUS ( data -> First{number}.Scaled ) }}"
        for number, name in enumerate(names)
    )
    model(folder / "names.xmi", names, message="{name}")
    return SYSTEM.format(connections="\n".join(connections), maps="\n".join(maps))


@pytest.mark.slow
def test_messages_may_have_names_of_every_target(tmp_path: Path) -> None:
    needs.ask("compiler")
    taken = {*runtime_names(), *STANDARD, *WIRE, *f"{OF_CPP} {OF_LUA} {OF_ROS}".split()}
    # Two messages whose classes have one name are no subject here.
    names = sorted({re.sub("[_ ]", "", each).lower(): each for each in taken}.values())
    path = tmp_path / "system.ros2jaus"
    path.write_text(system(tmp_path, names), encoding="utf-8")
    result = read_models([path], notations=NOTATIONS)
    assert not result.diagnostics
    folder = tmp_path / "ws"
    every = [
        MESSAGES,
        COMPONENT,
        BRIDGE,
        RUNTIME,
        CODEC_CPP,
        WIRESHARK,
        ROS_INTERFACES.for_whole_library(),
    ]
    write(result.model, every, folder)
    run = [sys.executable, "-c", "import unit.unit, front.front; front.front.Front()"]
    subprocess.run(run, check=True, env={"PYTHONPATH": python_path(folder)}, cwd=tmp_path)
    (header,) = folder.rglob("*_jaus.hpp")
    line = [str(compiler()), "-std=c++17", "-fsyntax-only", "-x", "c++", str(header)]
    subprocess.run(line, check=True)
    (dissector,) = folder.rglob("*.lua")
    lua = lua54.LuaRuntime(unpack_returned_tuples=True).globals().load
    assert not isinstance(lua(dissector.read_text("utf-8")), tuple)
    definitions = [*folder.rglob("*.msg")]
    assert len(definitions) > len(names)
    for each in definitions:
        assert parse_definition(each.read_text("utf-8"), "msg").faults == [], each.name
