"""A name that generated code uses itself may stand anywhere in a model, in every target."""

import ast
import builtins
import re
import subprocess
import sys
from collections.abc import MutableSequence, Sequence
from functools import cache
from keyword import iskeyword, kwlist, softkwlist
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any, get_args, get_origin, get_type_hints

import needs
import pytest
from generated import WITHOUT_PLUGINS
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lupa import lua54
from scripts import succeeded
from sweeps import WHOLE
from workspaces import python_path, write

from jausml.generation.native import compiler
from jausml.generation.python.modules import STANDARD
from jausml.generation.target import Target
from jausml.language.interfaces import parse_definition
from jausml.language.model import Severity, read_models
from jausml.language.semantics.names import DEVICES, LONGEST, is_identifier, snake_case
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check
from jausml.language.validation.rules.bridge.deployment import PARAMETERS
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.codec_cpp.target import TARGET as CODEC_CPP
from jausml_generators.jaus_component.target import TARGET as COMPONENT
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.python.names import WIRE, class_name, package_name
from jausml_generators.ros_interfaces.target import TARGET as ROS_INTERFACES
from jausml_generators.ros_node.target import TARGET as NODE
from jausml_generators.runtime.target import TARGET as RUNTIME
from jausml_generators.wireshark.target import TARGET as WIRESHARK

from .codec_support import load, read_messages, render

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
        <fields xsi:type="jaus:Variant" name="{name} or">
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
    xmlns:jaus="http://www.jausml.org/jaus/1.0" name="names">{services}</jaus:ServiceSet>
"""
SERVICE = """
  <services name="{name}" urn="urn:names:{name}">{messages}</services>
"""
STATEFUL = """
  <services name="{name}" urn="urn:names:{name}">{messages}
    <outputs name="{name}_told" code="{code:#06x}"/>
    <events name="{name}"/>
    <machines name="{name}">
      <states name="{name}" initial="true">
        <entry name="{action}"/>
        <transitions event="{name}" guard="{guard}" target="{name}s">
          <actions name="{action}" sends="//@services.{number}/@outputs.0"/>
        </transitions>
      </states>
      <states name="{name}s">
        <exit name="{action}s"/>
        <transitions message="//@services.{number}/@inputs.0" guard="{guard}( msg )"
            target="{name}s.{name}">
          <actions name="{action}"/>
        </transitions>
        <states name="{name}" initial="true"/>
      </states>
    </machines>
  </services>
"""


def message(number: int, name: str, message_name: str) -> str:
    """Returns a message that has the name wherever a name may stand in it."""
    return MESSAGE.format(message=message_name, number=number, code=0xD100 + number, name=name)


def model(path: Path, names: Sequence[str]) -> Path:
    """Writes a service with a message for each name."""
    messages = (message(number, name, f"Report{number}") for number, name in enumerate(names))
    service = SERVICE.format(name="Names", messages="".join(messages))
    path.write_text(MODEL.format(services=service))
    return path


def services(path: Path, names: Sequence[str]) -> None:
    """Writes a service of each name, which takes and sends messages, and whose states have it.

    An action has no name of a guard, so services have the name in turns for one and the other.
    """
    found = []
    for number, name in enumerate(names):
        sent = message(number, name, name)
        taken = sent.replace("<outputs", "<inputs").replace("</outputs", "</inputs")
        action, guard = (name, f"g{number}") if number % 2 else (f"a{number}", name)
        kinds = {"name": name, "number": number, "action": action, "guard": guard}
        found.append(STATEFUL.format(**kinds, code=0xE100 + number, messages=taken))
    path.write_text(MODEL.format(services="".join(found)))


def names_used(folder: Path) -> list[str]:
    """Returns the names in a module of messages: imported, called, defined and assigned ones."""
    found = {*WIRE, *STANDARD}
    text = render(read_messages(model(folder / "plain.xmi", ("Plain",))))
    for node in ast.walk(ast.parse(text)):
        for part in ("id", "name", "arg", "attr"):
            found.add(getattr(node, part, None) or "")
    return sorted(name for name in found if name.isidentifier() and "lain" not in name)


def filled(message: Any, module: ModuleType) -> Any:
    """Returns a message with an element in each of its lists."""
    known = {**vars(module), "MutableSequence": MutableSequence}
    hints = get_type_hints(type(message), known)
    for name, hint in hints.items():
        if get_origin(hint) is MutableSequence:
            (element,) = get_args(hint)
            getattr(message, name).append(element())
    return message


def test_names_of_generated_python_may_stand_in_messages(tmp_path):
    names = names_used(tmp_path)
    assert {"Octet", "octet_records", "write_records", "offset", "CODE", "DecodeError"} <= {*names}
    module = load(render(read_messages(model(tmp_path / "names.xmi", tuple(names)))), "every_name")
    for number, name in enumerate(names):
        message = filled(getattr(module, f"Report{number}")(), module)
        assert type(message).decode(message.encode()) == message, name


ROS = """<?xml version="1.0" encoding="UTF-8"?>
<ros:InterfacePackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:ros="http://www.jausml.org/ros/1.0" name="own_msgs">{types}</ros:InterfacePackage>
"""
TYPE = """
    <messages name="{type}">
      <fields xsi:type="ros:PrimitiveField" name="{field}" type="float64"/>
      <fields xsi:type="ros:PrimitiveField" name="more" type="uint8" arrayKind="unboundedSequence"/>
      <constants name="{constant}" type="uint8" value="1"/>
    </messages>
    <services name="{type}">
      <request name="{type}_Request">
        <fields xsi:type="ros:PrimitiveField" name="{field}" type="float64"/>
        <constants name="{constant}" type="uint8" value="1"/>
      </request>
      <response name="{type}_Response">
        <fields xsi:type="ros:PrimitiveField" name="{field}" type="bool"/>
      </response>
    </services>
    <actions name="{type}">
      <goal name="{type}_Goal">
        <fields xsi:type="ros:MessageField" name="{field}" arrayKind="unboundedSequence">
          <messageType href="http://www.jausml.org/library/ros/geometry_msgs.xmi#PoseStamped"/>
        </fields>
        <constants name="{constant}" type="uint8" value="1"/>
      </goal>
      <result name="{type}_Result">
        <fields xsi:type="ros:PrimitiveField" name="{field}" type="string"/>
      </result>
      <feedback name="{type}_Feedback">
        <fields xsi:type="ros:PrimitiveField" name="{field}" type="uint32"/>
      </feedback>
    </actions>
"""
SYSTEM = """
import "names.xmi"
import "own_msgs.xmi"
import mappings.local_waypoint_driver
component `{unit}` {{ address: 1.1.1  provides: {services} }}
bridge `{front}` {{ address: 1.1.2  uses: {services}
{connections}
}}
bridge `{caller}` {{ address: 1.1.3  provides: {services}
{calls}
}}
component `{driver}` {{ address: 1.1.4  provides: LocalWaypointListDriver }}
node `{node}` {{
{members}
}}
{maps}
"""
CONNECTION = """
    connection `{name}` {{ map: `{name}`  direction: rosToJaus  exchange: message
        peers: `{unit}`  control: false  topic `{name}` {{}} }}
"""
CALLS = (
    """
    ros_service_connection `{name}` {{ service: `{name}`  type: own_msgs/{type}
        direction: jausToRos  request: `{name}_asked`  successMember: `{field}` }}
""",
    """
    ros_service_connection `{name}` {{ service: `{name}`  type: own_msgs/{type}
        request: `{name}_asked`  peers: `{unit}`  successMember: `{field}` }}
""",
    """
    ros_action_connection `{name}` {{ action: `{name}`  type: own_msgs/{type}
        direction: rosToJaus  driver: LocalWaypointListDriver  element: local_waypoint
        goalMember: `{field}`  progressMember: `{field}`  reasonMember: `{field}`
        peers: `{driver}`  speed: 1 }}
""",
)
MAP = """
`{name}_asked` {{ JAUS `{name}`.`{name}`  ROS own_msgs/{type}.request
    JAUS->ROS ( First{number}.Scaled -> `{field}` {{ whenAbsent: leave }} )
    ROS->JAUS ( `{field}` -> First{number}.Scaled )
}}
`{name}` {{ JAUS `{name}`.`{name}`  ROS own_msgs/{type}
    quantity `{name}` {{ value: 2 }}
    table `{name}` ( a <-> 0  b <-> 1 )
    join `{other}` {{ type: own_msgs/{type} }}
    ROS->JAUS ( `{field}` -> First{number}.Scaled : scale(`{name}`)
        `{other}`.more[0] -> First{number}.Text : look_up(`{name}`) {{ whenAbsent: leave }} )
    JAUS->ROS ( First{number}.Scaled -> `{field}` : scale(`{name}`) {{ whenAbsent: leave }} )
}}
"""
MEMBER = """
    parameter `{name}` {{ type: double  value: 1 }}
    {kind} `{name}` {{ topic: node/`{name}`  type: std_msgs/Float64 }}
    {service_kind} `{name}_too` {{ service: node/`{name}`  type: own_msgs/{type} }}
"""
PYTHON = [MESSAGES, COMPONENT, BRIDGE, NODE, RUNTIME]
OTHERS = [CODEC_CPP, WIRESHARK]
IMPORTED = """
import importlib, pathlib
for path in sorted(pathlib.Path().glob("*/*/*.py")):
    if path.parts[0] == path.parts[1] and path.parts[0] not in ("jausml_runtime", "{node}"):
        importlib.import_module(f"{{path.parts[0]}}.{{path.stem}}")
from jausml_runtime import Bridge
for base in Bridge.__subclasses__():
    (bridge,) = base.__subclasses__()
    bridge()
"""
PLAIN = ("Plain", "SimpleOne", "other_one", "AnyOther", "LastOne")
FORMS = (str, str.upper, str.lower, str.capitalize, class_name, snake_case, "{}_".format)


def system(folder: Path, names: Sequence[str]) -> Path:
    """Writes a system of a component, a bridge and a node, in which all has these names."""
    services(folder / "names.xmi", names)
    types, parts = [], []
    for number, name in enumerate(names):
        field = snake_case(name)
        field = f"f{number}" if iskeyword(field) or field in ("true", "false") else field
        kinds = {"type": class_name(name), "field": field, "constant": field.upper()}
        types.append(TYPE.format(**kinds))
        kind = ("publisher", "subscription")[number % 2]
        other = names[number - 1]
        part = {**kinds, "name": name, "other": other, "number": number, "kind": kind}
        part["service_kind"] = ("service_server", "service_client")[number % 2]
        parts.append({**part, "unit": names[0], "driver": names[4]})
    (folder / "own_msgs.xmi").write_text(ROS.format(types="".join(types)))
    path = folder / "system.ros2jaus"
    text = SYSTEM.format(
        unit=names[0],
        front=names[1],
        node=names[2],
        caller=names[3],
        driver=names[4],
        services=", ".join(f"`{name}`" for name in names),
        calls="".join(CALLS[number % 3].format(**part) for number, part in enumerate(parts)),
        connections="".join(CONNECTION.format(**part_fields) for part_fields in parts),
        members="".join(MEMBER.format(**part_fields) for part_fields in parts),
        maps="".join(MAP.format(**part_fields) for part_fields in parts),
    )
    path.write_text(text, encoding="utf-8")
    return path


def generated(folder: Path, names: Sequence[str], targets: Sequence[Target[Any]] = ()) -> Path:
    """Returns the workspace of a system of these names."""
    result = check(read_models([system(folder, names)], notations=NOTATIONS))
    faults = [error for error in result.diagnostics if error.severity is Severity.ERROR]
    assert not faults, faults[:3]
    workspace = folder / "ws"
    write(result.model, [*PYTHON, *targets], workspace)
    return workspace


def imported(folder: Path, names: Sequence[str], targets: Sequence[Target[Any]] = ()) -> Path:
    """Returns such a workspace, whose Python can be imported."""
    workspace = generated(folder, names, targets)
    code = IMPORTED.format(node=package_name(names[2]))
    path = {"PYTHONPATH": python_path(workspace)}
    succeeded([sys.executable, "-c", code], env=path, cwd=workspace)
    return workspace


@cache
def words() -> list[str]:
    """Returns the words that generated files use, of Python and its library, and of C++ and Lua."""
    with TemporaryDirectory() as folder:
        workspace = generated(Path(folder), PLAIN, OTHERS)
        found = {*dir(builtins), *kwlist, *softkwlist, *sys.stdlib_module_names}
        for path in workspace.rglob("*.*"):
            if path.suffix in {".py", ".hpp", ".cpp", ".lua", ".msg"}:
                found.update(re.findall(r"[A-Za-z]\w*", path.read_text("utf-8")))
    return sorted(word for word in found if word.isascii() and len(word) < LONGEST)


OF_MODEL = frozenset({"first", "scaled", "text", "real", "last", "other", "more"})
"""Names that stand beside the drawn ones in the model of this test."""


def is_legal(name: str) -> bool:
    """Whether a name may stand everywhere: of types and topics of ROS, and of parameters."""
    is_ros = is_identifier(name) and "__" not in name and class_name(name).lower() not in DEVICES
    return is_ros and name not in PARAMETERS and snake_case(name) not in OF_MODEL


@st.composite
def names(draw: st.DrawFn, size: int) -> list[str]:
    """Draws names, mostly such as generated files use, of which code makes different names."""
    known = st.builds(
        lambda word, form: form(word), st.sampled_from(words()), st.sampled_from(FORMS)
    )
    any_name = st.from_regex("[A-Za-z][A-Za-z0-9_]{0,9}", fullmatch=True)
    legal = (known | known | known | any_name).filter(is_legal)
    keys = (lambda name: class_name(name).lower(),)
    found: list[str] = draw(st.lists(legal, min_size=size, max_size=size, unique_by=keys))
    return found


FOUND = ["Number", "self", "EAGAIN", "cls", "data"]
"""Names with which something could not be imported or compiled once."""


@settings(max_examples=1, deadline=None, suppress_health_check=list(HealthCheck))
@given(drawn=names(6))
def test_any_names_may_stand_anywhere(drawn):
    with TemporaryDirectory() as folder:
        imported(Path(folder), with_found(drawn))


def with_found(drawn: list[str]) -> list[str]:
    """Returns names with those that were found, one of those that become the same class."""
    return list({class_name(name).lower(): name for name in (*drawn, *FOUND)}.values())


def run_tests(workspace: Path, node: str) -> None:
    """Runs the tests in a workspace, but for those of the node, whose types nobody has built."""
    tests = [path for path in workspace.glob("*/test/test_*.py") if node not in path.parts]
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *map(str, tests)]
    path = {"PYTHONPATH": python_path(workspace)}
    succeeded(command, env={**WITHOUT_PLUGINS, **path}, cwd=workspace)


@pytest.mark.slow
@settings(max_examples=1, deadline=None, suppress_health_check=list(HealthCheck))
@given(drawn=names(24 if WHOLE else 6).map(with_found))
def test_any_names_may_stand_in_every_target(drawn):
    needs.ask("compiler")
    with TemporaryDirectory() as folder:
        every = [*OTHERS, ROS_INTERFACES.for_whole_library()]
        workspace = imported(Path(folder), drawn, every)
        for source in (*workspace.rglob("*_jaus.hpp"), *workspace.rglob("core.cpp")):
            line = [str(compiler()), "-std=c++17", "-fsyntax-only", "-x", "c++", str(source)]
            subprocess.run(line, check=True)
        run_tests(workspace, package_name(drawn[2]))
        lua = lua54.LuaRuntime(unpack_returned_tuples=True).globals().load
        for dissector in workspace.rglob("*.lua"):
            assert not isinstance(lua(dissector.read_text("utf-8")), tuple)
        definitions = [*workspace.rglob("*.msg")]
        assert len(definitions) >= len(drawn)
        for definition in definitions:
            assert parse_definition(definition.read_text("utf-8"), "msg").faults == [], (
                definition.name
            )
