#!/usr/bin/env python3
"""Writes the JAUS service sets of models/library/jaus from a facts file.

The facts file is JSON: the services of each set with their messages, described with the words of
SAE AS5684 (names, codes, field order, types, units, ranges). Axes, and units that the facts lack,
come from jaus_frames.ini beside this tool, states and internal events of the core services from
jaus_machines.ini, and what these events carry from jaus_events.json.
The same facts give the same bytes.

Usage: python tools/build_jaus_library.py FACTS.json OUTPUT_FOLDER
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from configparser import ConfigParser
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

Facts = Mapping[str, Any]

FRAMES = Path(__file__).with_name("jaus_frames.ini")
MACHINES = Path(__file__).with_name("jaus_machines.ini")
EVENTS = Path(__file__).with_name("jaus_events.json")

MOVES_NOTHING = frozenset(
    [
        "AddNoGoZone",
        "CancelEvent",
        "ControlDigitalVideoSensorStream",
        "CreateEvent",
        "DeleteElement",
        "RegisterServices",
        "RemoveDigitalResourceEndpoint",
        "RemoveNoGoZone",
        "ResetOdometry",
        "SetAuthority",
        "SetElement",
        "SetEmergency",
        "SetGeomagneticProperty",
        "SetGlobalPose",
        "SetIlluminationState",
        "SetLocalPose",
        "SetTime",
        "SetVisualSensorConfiguration",
        "Standby",
        "UpdateEvent",
        "UpdateUGVSummary",
    ]
)
"""Commands that set nothing in motion: they state where the vehicle is, what time it is or what is
stored, they switch lamps or cameras, or they stop. Elements of lists move nothing until ExecuteList
(AS6009). CreateCommandEvent is none of them: what it carries is obeyed."""


LIST_ELEMENTS = {
    "ReportGlobalPathSegment": "SetGlobalPathSegment",
    "ReportLocalPathSegment": "SetLocalPathSegment",
}
"""Commands by the reports that are laid out as they are (AS6009), whose services do not list them.

JAUS-DEVIATION: they are inputs of the drivers whose lists hold them, as SetLocalWaypoint is one."""


@dataclass(frozen=True)
class SetFile:
    """Where a service set goes.

    Attributes:
        key: Its key in the facts file.
        file: File name in the library.
        name: Name of the ServiceSet.
        version: Version of the ServiceSet.
        documentation: What the set is for.
    """

    key: str
    file: str
    name: str
    version: str
    documentation: str


SETS = (
    SetFile("core-v1.0", "core-1.0.xmi", "core", "1.0", "Core services of AS5710."),
    SetFile("core-v1.1", "core-1.1.xmi", "core", "1.1", "Core services of AS5710A."),
    SetFile("mobility", "mobility.xmi", "mobility", "1.0", "Mobility services of AS6009."),
    SetFile(
        "environmentSensing",
        "environment-sensing.xmi",
        "environment_sensing",
        "1.0",
        "Environment sensing services of AS6060.",
    ),
    SetFile(
        "manipulator",
        "manipulator-1.0.xmi",
        "manipulator",
        "1.0",
        "Manipulator services of AS6057.",
    ),
    SetFile(
        "manipulator-v2.0",
        "manipulator-2.0.xmi",
        "manipulator",
        "2.0",
        "Manipulator services of AS6057A.",
    ),
    SetFile("ugv", "ugv.xmi", "ugv", "1.0", "Unmanned ground vehicle services of AS6091."),
    SetFile("iop", "iop.xmi", "iop", "1.1", "Services of the interoperability profiles (IOP)."),
)

NUMERIC_TYPES = {
    "u8": "uint8",
    "i8": "int8",
    "u16": "uint16",
    "i16": "int16",
    "u32": "uint32",
    "i32": "int32",
    "u64": "uint64",
    "i64": "int64",
    "f32": "float32",
    "f64": "float64",
}

_ATTRIBUTE_ESCAPES = {'"': "&quot;", "\n": "&#10;", "\t": "&#9;"}


@dataclass
class Element:
    """An XML element with its attributes in the order they are written."""

    tag: str
    attributes: dict[str, str] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)
    text: str = ""

    def lines(self, indent: str = "") -> Iterator[str]:
        """Yields the element as lines, one for each element as EMF writes them."""
        attributes = "".join(
            f' {name}="{escape(value, _ATTRIBUTE_ESCAPES)}"'
            for name, value in self.attributes.items()
        )
        if self.text:
            yield f"{indent}<{self.tag}{attributes}>{escape(self.text)}</{self.tag}>"
            return
        if not self.children:
            yield f"{indent}<{self.tag}{attributes}/>"
            return
        yield f"{indent}<{self.tag}{attributes}>"
        for child in self.children:
            yield from child.lines(indent + "  ")
        yield f"{indent}</{self.tag}>"


def field_element(tag: str, facts: Facts) -> Element:
    """Returns a field, container or array as an element.

    Args:
        tag: Name of the feature that holds it.
        facts: Its facts.
    """
    kind, features = FIELD_KINDS[facts["kind"]]
    element = Element(tag, {"xsi:type": f"jaus:{kind}", "name": facts["name"]})
    if facts.get("optional"):
        element.attributes["optional"] = "true"
    if "frame" in facts:
        element.attributes["frame"] = facts["frame"]
    features(element, facts)
    return element


def _record(element: Element, facts: Facts) -> None:
    if "presence_vector" in facts:
        element.attributes["presenceVector"] = NUMERIC_TYPES[facts["presence_vector"]]
    element.children += [field_element("fields", member) for member in facts["fields"]]


def _list(element: Element, facts: Facts) -> None:
    _numeric(element, "countType", facts["count"], "uint8")
    _limits(element, facts, facts["count"], "Count")
    element.children.append(field_element("element", _only(facts["fields"])))


def _variant(element: Element, facts: Facts) -> None:
    _numeric(element, "tagType", facts["count"], "uint8")
    element.children += [field_element("options", option) for option in facts.get("fields", ())]


def _array(element: Element, facts: Facts) -> None:
    element.children.append(field_element("element", _only(facts["fields"])))
    element.children += [
        Element("dimensions", text=str(dimension["size"])) for dimension in facts["dimensions"]
    ]


def _fixed_field(element: Element, facts: Facts) -> None:
    _numeric(element, "type", facts["type"], "uint8")
    if "units" in facts:
        element.attributes["units"] = " ".join(facts["units"].split())
    if "scale" in facts:
        scale = facts["scale"]
        attributes = {"lower": repr(float(scale["lower"])), "upper": repr(float(scale["upper"]))}
        if scale["function"] != "round":
            attributes["rounding"] = scale["function"]
        element.children.append(Element("scale", attributes))
    _values(element, facts)


def _bit_field(element: Element, facts: Facts) -> None:
    _numeric(element, "type", facts["type"], "uint8")
    for sub in facts["sub_fields"]:
        attributes = {"name": sub["name"], "lowBit": str(sub["from"]), "highBit": str(sub["to"])}
        child = Element("subFields", attributes)
        _values(child, sub)
        element.children.append(child)


def _variable_field(element: Element, facts: Facts) -> None:
    for alternative in facts["types"]:
        name, index = alternative["name"], str(alternative["index"])
        child = Element("alternatives", {"name": name, "index": index})
        _fixed_field(child, alternative)
        element.children.append(child)


def _fixed_length_string(element: Element, facts: Facts) -> None:
    element.attributes["length"] = str(facts["length"])


def _variable_length_string(element: Element, facts: Facts) -> None:
    _numeric(element, "countType", facts["count"], "uint8")
    _limits(element, facts, facts["count"], "Length")


def _variable_length_field(element: Element, facts: Facts) -> None:
    _numeric(element, "countType", facts["count"], "uint32")
    # The facts give no format; by the standard's naming an embedded message is called a message.
    if not facts["name"].endswith(("Message", "MessagePayload")):
        element.attributes["format"] = facts.get("format", "octets")
    _limits(element, facts, facts["count"], "Length")


def _variable_format_field(element: Element, facts: Facts) -> None:
    _numeric(element, "countType", facts["count"], "uint16")
    _limits(element, facts, facts["count"], "Length")
    for item in facts["formats"]:
        attributes = {"name": " ".join(item["format"].split()), "index": str(item["index"])}
        element.children.append(Element("formats", attributes))


FIELD_KINDS = {
    "record": ("Record", _record),
    "sequence": ("Sequence", _record),
    "list": ("List", _list),
    "variant": ("Variant", _variant),
    "array": ("Array", _array),
    "fixed_field": ("FixedField", _fixed_field),
    "bit_field": ("BitField", _bit_field),
    "variable_field": ("VariableField", _variable_field),
    "fixed_length_string": ("FixedLengthString", _fixed_length_string),
    "variable_length_string": ("VariableLengthString", _variable_length_string),
    "variable_length_field": ("VariableLengthField", _variable_length_field),
    "variable_format_field": ("VariableFormatField", _variable_format_field),
}


@dataclass(frozen=True)
class FrameRule:
    """Axes and units that several fields have.

    Attributes:
        messages: Names of messages.
        fields: Patterns for fields; one with a dot also for the name of what is around the field.
        facts: The frame, the units or both.
    """

    messages: Sequence[str]
    fields: Sequence[str]
    facts: Facts

    def covers(self, message: str, around: str, name: str) -> bool:
        """Says whether the rule is for a field of a message."""
        return message in self.messages and any(
            fnmatchcase(f"{around}.{name}" if "." in pattern else name, pattern)
            for pattern in self.fields
        )


@cache
def frame_rules() -> Sequence[FrameRule]:
    """Returns the rules of jaus_frames.ini."""
    parser = ConfigParser(interpolation=None)
    parser.read_string(FRAMES.read_text(encoding="utf-8"))
    return [
        FrameRule(
            parser[name]["messages"].split(),
            parser[name]["fields"].split(),
            {key: parser[name][key] for key in ("frame", "units") if key in parser[name]},
        )
        for name in parser.sections()
    ]


def with_frames(message: str, facts: Facts, around: str = "") -> Facts:
    """Returns a field with the axes and the units that the rules for its message state.

    Args:
        message: Name of the message.
        facts: The facts of the field.
        around: Name of the record, list or other field around it.
    """
    name = facts["name"]
    added: dict[str, Any] = {}
    for rule in frame_rules():
        if rule.covers(message, around, name):
            added |= rule.facts
    if "fields" in facts:
        added["fields"] = [with_frames(message, member, name) for member in facts["fields"]]
    return {**facts, **added}


def _only(fields: Sequence[Facts]) -> Facts:
    (only,) = fields
    return only


def _numeric(element: Element, feature: str, type_code: str, default: str) -> None:
    name = NUMERIC_TYPES[type_code]
    if name != default:
        element.attributes[feature] = name


def _limits(element: Element, facts: Facts, type_code: str, what: str) -> None:
    largest = 2 ** int(type_code[1:]) - 1
    minimum, maximum = int(facts.get("min", 0)), int(facts.get("max", largest))
    if minimum > 0:
        element.attributes[f"minimum{what}"] = str(minimum)
    if maximum < largest:
        element.attributes[f"maximum{what}"] = str(maximum)


def _values(element: Element, facts: Facts) -> None:
    if not facts.get("values"):
        return
    values = Element("values")
    for value in facts["values"]:
        if "range" in value:
            lower, upper = (repr(float(limit)) for limit in value["range"])
            attributes = {"xsi:type": "jaus:ValueRange", "lower": lower, "upper": upper}
            for side, bound in zip(("lower", "upper"), value["bounds"], strict=True):
                if bound == "exclusive":
                    attributes[f"{side}Inclusive"] = "false"
        else:
            attributes = {
                "xsi:type": "jaus:EnumeratedValue",
                "name": " ".join(value["name"].split()),
                "value": str(value["index"]),
            }
        values.children.append(Element("values", attributes))
    element.children.append(values)


def message_element(tag: str, service: str, facts: Facts) -> Element:
    """Returns a message of a service as an element.

    Args:
        tag: `inputs` or `outputs`.
        service: Name of the service, the first part of the message's id.
        facts: The message.
    """
    name = facts["name"]
    code = f"0x{int(facts['id'], 16):04X}"
    element = Element(tag, {"xmi:id": f"{service}.{name}", "name": name, "code": code})
    if facts["command"]:
        element.attributes["isCommand"] = "true"
    if name in MOVES_NOTHING:
        element.attributes["moves"] = "false"
    body = facts.get("body", {}).get("fields", [])
    element.children += [field_element("body", with_frames(name, field)) for field in body]
    return element


def service_element(
    facts: Facts, places: Mapping[tuple[str, str], str], file: str, owners: Mapping[str, str]
) -> Element:
    """Returns a service as an element.

    Args:
        facts: The service.
        places: File and id (`file#id`) of every service by URN and version.
        file: The file that the element is written to.
        owners: Ids of the messages of its set by their names.
    """
    name = facts["name"]
    attributes = {"xmi:id": name, "name": name, "urn": facts["urn"], "version": facts["version"]}
    element = Element("services", attributes)
    inherits = facts.get("inherits")
    if inherits:
        base_file, base_id = places[inherits["urn"], inherits["version"]].split("#")
        if base_file == file:
            attributes["inherits"] = base_id
        else:
            element.children.append(Element("inherits", {"href": f"{base_file}#{base_id}"}))
    for tag, messages in (
        ("inputs", [*facts["input"], *_unlisted(facts)]),
        ("outputs", facts["output"]),
    ):
        element.children += [message_element(tag, name, message) for message in messages]
    element.children += behaviour_elements(facts, owners)
    return element


def _unlisted(service: Facts) -> list[Facts]:
    """Returns the commands that the lists of a service hold, and that the facts do not name."""
    return [
        {
            **report,
            "name": LIST_ELEMENTS[report["name"]],
            "id": f"{int(report['id'], 16) & 0x0FFF:04X}",
            "command": True,
        }
        for report in service["output"]
        if report["name"] in LIST_ELEMENTS
    ]


def behaviour_elements(facts: Facts, owners: Mapping[str, str]) -> Iterator[Element]:
    """Yields the internal events and the machine of a core service.

    The names of states are paths, so that those of inherited services need not be said again.

    Args:
        owners: Ids of the messages of its set by their names.
    """
    key = f"{facts['urn']} {facts['version']}"
    section = machines()[key] if machines().has_section(key) else {}
    events = section.get("events", "").split()
    for name in events:
        body = [field_element("body", event_bodies()[name])] if name in event_bodies() else []
        yield Element("events", {"name": name}, body)
    paths = section.get("states", "").split()
    rows = [line.strip().split(" | ") for line in section.get("transitions", "").splitlines()]
    rows = [transition for transition in rows if len(transition) > 1]
    around = dict.fromkeys(_path_of(state) for state, *_ in rows)
    states = {path: Element("states", {"name": path}) for path in around if path not in paths}
    for path in paths:
        outer = path.rpartition(".")[0]
        first = next(sibling for sibling in paths if sibling.rpartition(".")[0] == outer)
        states[path] = Element("states", {"name": path})
        if path == first:
            states[path].attributes["initial"] = "true"
    for state, *row in rows:
        tag = "defaults" if state.endswith("*") else "transitions"
        states[_path_of(state)].children.append(_transition(tag, row, owners))
    if states:
        yield Element("machines", {"name": "ReceiveFSM"}, list(states.values()))


_READY = "Receiving.Ready"


def _path_of(state: str) -> str:
    return ".".join(filter(None, (_READY, state.removesuffix(" *").strip("-"))))


def _transition(tag: str, row: Sequence[str], owners: Mapping[str, str]) -> Element:
    trigger, guard, target, sent = row
    element = Element(tag)
    element.attributes["message" if trigger in owners else "event"] = owners.get(trigger, trigger)
    if guard != "-":
        element.attributes["guard"] = guard
    kind = {"-": "internal", "before": "pop"}.get(target)
    if trigger == "SetEmergency":
        kind = "push"  # to which the end of the emergency leads back
    if kind is not None:
        element.attributes["kind"] = kind
    if target not in ("-", "before"):
        element.attributes["target"] = f"{_READY}.{target}"
    for word in sent.split(", ") if sent != "-" else ():
        name, _, other = word.partition(" (")
        is_answer = trigger in owners and not other
        element.children.append(_sending(name, owners, is_answer=is_answer))
    return element


def _sending(sent: str, owners: Mapping[str, str], *, is_answer: bool) -> Element:
    """Returns the action that sends a message, with the code that it carries."""
    message, *codes = words = sent.split()
    name = "".join(["send", message, *(code.title().replace("_", "") for code in codes)])
    action = Element("actions", {"name": name})
    arguments = [f"'{word}'" for word in words]
    if is_answer:
        action.attributes["sends"] = owners[message]
        arguments.append("transportData")
    action.children = [Element("arguments", text=argument) for argument in arguments]
    return action


@cache
def machines() -> ConfigParser:
    """Returns what jaus_machines.ini says."""
    parser = ConfigParser(interpolation=None)
    parser.read_string(MACHINES.read_text(encoding="utf-8"))
    return parser


@cache
def event_bodies() -> Mapping[str, Facts]:
    """Returns what jaus_events.json says, by the names of the events."""
    bodies: dict[str, Facts] = json.loads(EVENTS.read_text(encoding="utf-8"))["events"]
    return bodies


def service_set(place: SetFile, services: Sequence[Facts], places: Mapping[Any, str]) -> str:
    """Returns the text of one file of the library.

    Args:
        place: The set.
        services: The facts of its services.
        places: File and id of every service by URN and version.
    """
    root = Element(
        "jaus:ServiceSet",
        {
            "xmi:version": "2.0",
            "xmlns:xmi": "http://www.omg.org/XMI",
            "xmlns:xsi": "http://www.w3.org/2001/XMLSchema-instance",
            "xmlns:jaus": "http://www.jausml.org/jaus/1.0",
            "xmi:id": place.name,
            "name": place.name,
            "documentation": place.documentation,
        },
    )
    if place.version != "1.0":
        root.attributes["version"] = place.version
    owners = {
        message["name"]: f"{facts['name']}.{message['name']}"
        for facts in services
        for message in (*facts["input"], *facts["output"])
    }
    root.children += [service_element(facts, places, place.file, owners) for facts in services]
    return "\n".join(['<?xml version="1.0" encoding="UTF-8"?>', *root.lines(), ""])


def build(facts: Facts) -> dict[str, str]:
    """Returns the text of each file of the library by file name.

    Args:
        facts: The content of a facts file.
    """
    sets = facts["sets"]
    places = {
        (service["urn"], service["version"]): f"{place.file}#{service['name']}"
        for place in SETS
        for service in sets.get(place.key, ())
    }
    return {
        place.file: service_set(place, sets[place.key], places)
        for place in SETS
        if place.key in sets
    }


def main(arguments: Sequence[str]) -> int:
    """Runs the tool.

    Args:
        arguments: Facts file and output folder.

    Returns:
        The exit code.
    """
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    source, folder = map(Path, arguments)
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in build(json.loads(source.read_text(encoding="utf-8"))).items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
        print(folder / name)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
