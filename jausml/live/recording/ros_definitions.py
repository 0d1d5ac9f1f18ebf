"""Definitions of ROS types in MCAP files, as `ros2msg`.

That is the text of the type's .msg file, and after it those of all types in it, each below a line
of `=` and one with its name.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable

from jausml.language.cdr import short_name
from jausml.language.interfaces import Installation, parse_definition
from jausml.language.interfaces.definitions import is_type_name
from jausml.language.metamodel.classes import ros
from jausml.language.model.files import read_text
from jausml.language.semantics.ros_types import package_of

_LINE = "=" * 80

# The field that rosidl gives a type without fields, on the wire too.
_NO_FIELD = "uint8 structure_needs_at_least_one_member"

_GOAL_ID = "unique_identifier_msgs/UUID goal_id"
_CALL = "service_msgs/ServiceEventInfo info\n{0}_Request[<=1] request\n{0}_Response[<=1] response"

# Types of topics of services and actions, and those in them: each has fields, or a section of the
# file (REP 2012, rosidl action type support).
_ROLES: dict[tuple[str, str], dict[str, str | int]] = {
    ("srv", "Event"): {"Event": _CALL, "Request": 0, "Response": 1},
    ("action", "FeedbackMessage"): {
        "FeedbackMessage": f"{_GOAL_ID}\n{{0}}_Feedback feedback",
        "Feedback": 2,
    },
    ("action", "SendGoal_Event"): {
        "SendGoal_Event": _CALL.replace("{0}", "{0}_SendGoal"),
        "SendGoal_Request": f"{_GOAL_ID}\n{{0}}_Goal goal",
        "SendGoal_Response": "bool accepted\nbuiltin_interfaces/Time stamp",
        "Goal": 0,
    },
    ("action", "GetResult_Event"): {
        "GetResult_Event": _CALL.replace("{0}", "{0}_GetResult"),
        "GetResult_Request": _GOAL_ID,
        "GetResult_Response": "int8 status\n{0}_Result result",
        "Result": 1,
    },
}

# The text of a definition, and the types in it, e.g. `std_msgs/Header`.
Part = tuple[str, list[str]]


def full_name(kind: ros.MessageType) -> str:
    """Returns the full name of a ROS type, e.g. `nav_msgs/msg/Odometry`."""
    return f"{package_of(kind)}/msg/{kind.name}"


def modelled_definition(kind: ros.MessageType) -> str:
    """Returns the `ros2msg` text of a type of a model."""
    # It takes long to load, and installed types do not need it.
    from jausml_generators.ros_interfaces.definitions import section_of  # noqa: PLC0415

    known = {short_name(kind): kind}

    def part(name: str) -> Part:
        ros_type = known[name]
        inner = [
            field.messageType for field in ros_type.fields if isinstance(field, ros.MessageField)
        ]
        known.update((short_name(message_type), message_type) for message_type in inner)
        return "\n".join(section_of(ros_type).lines), [short_name(kind) for kind in inner]

    return _joined(short_name(kind), part)


def installed_definition(name: str, installation: Installation) -> str:
    """Returns the `ros2msg` text of an installed type, empty when its package is not installed.

    Args:
        name: Its full name, e.g. `nav_msgs/msg/Odometry`, or that of a type of topics of services
            and actions, e.g. `std_srvs/srv/SetBool_Event`.
    """

    def part(short: str) -> Part:
        if short in parts:
            return parts[short]
        package, _, own = short.partition("/")
        return _part(_text(installation, package, "msg", own), package)

    try:
        package, kind, own = name.split("/")
        parts = _interface_parts(package, kind, own, installation) if kind != "msg" else {}
        return _joined(f"{package}/{own}", part)
    except (OSError, ValueError):
        return ""


def _interface_parts(
    package: str, kind: str, own: str, installation: Installation
) -> dict[str, Part]:
    """Returns the types of a topic of a service or an action, which its file defines."""
    base, _, role = own.partition("_")
    if (kind, role) not in _ROLES:
        raise ValueError(f"{package}/{kind}/{own}")
    text = _text(installation, package, kind, base)
    sections = re.split(r"^---[ \t]*$", text, flags=re.MULTILINE)
    parts: dict[str, Part] = {}
    for suffix, source in _ROLES[kind, role].items():
        if isinstance(source, int):
            part = _part(sections[source].strip("\n"), package, _NO_FIELD)
        else:
            fields = source.format(f"{package}/{base}")
            part = fields, re.findall(r"^\w+/\w+", fields, re.MULTILINE)
        parts[f"{package}/{base}_{suffix}"] = part
    return parts


def _text(installation: Installation, package: str, kind: str, own: str) -> str:
    folder = installation.folder(package)
    if folder is None or not is_type_name(own):
        raise FileNotFoundError(f"{package}/{own}")
    return read_text(folder / kind / f"{own}.{kind}")


def _part(text: str, package: str, without_fields: str = "") -> Part:
    """Returns a definition and the types in it (`without_fields`: text for an empty one)."""
    fields = [field for part in parse_definition(text, "msg").sections for field in part.fields]
    inner = [
        f"{field.type.package or package}/{field.type.name}"
        for field in fields
        if not field.type.is_primitive
    ]
    return text if fields or not without_fields else without_fields, inner


def _joined(name: str, part: Callable[[str], Part]) -> str:
    """Returns the definition of a type, and after it once each those of the types in it."""
    text, inner = part(name)
    texts = {name: text}
    waiting = deque(inner)
    while waiting:
        type_name = waiting.popleft()
        if type_name not in texts:
            text, inner = part(type_name)
            texts[type_name] = f"{_LINE}\nMSG: {type_name}\n{text}"
            waiting += inner
    return "\n".join(text.rstrip("\n") for text in texts.values()) + "\n"
