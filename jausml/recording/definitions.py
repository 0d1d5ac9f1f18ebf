"""Definitions of ROS types as an MCAP file has them (schema encoding `ros2msg`).

That is the text of the type's .msg file, and after it those of all types in it, each below a line
of `=` and one with its name.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generators.ros_interfaces.ros_types import section_of
from jausml.interfaces import Installation, parse_definition
from jausml.interfaces.types import is_type_name
from jausml.metamodel.classes import ros
from jausml.semantics.installed import package_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

_LINE = "=" * 80

Part = tuple[str, list[str]]
"""The text of a definition, and the types in it, e.g. `std_msgs/Header`."""


def full_name(kind: ros.MessageType) -> str:
    """Returns the name of a type as ROS says it, e.g. `nav_msgs/msg/Odometry`."""
    return f"{package_of(kind)}/msg/{kind.name}"


def modelled_definition(kind: ros.MessageType) -> str:
    """Returns the definition of a type of a model.

    Args:
        kind: The type.
    """
    known = {_short(kind): kind}

    def part(name: str) -> Part:
        found = known[name]
        inner = [each.messageType for each in found.fields if isinstance(each, ros.MessageField)]
        known.update((_short(each), each) for each in inner)
        return "\n".join(section_of(found).lines), [_short(each) for each in inner]

    return _joined(_short(kind), part)


def installed_definition(name: str, installation: Installation) -> str:
    """Returns the definition of an installed type, empty when its package is not installed.

    Args:
        name: Its full name, e.g. `nav_msgs/msg/Odometry`.
        installation: Where packages are installed.
    """

    def part(short: str) -> Part:
        package, _, own = short.partition("/")
        folder = installation.folder(package)
        if folder is None or not is_type_name(own):
            raise FileNotFoundError(short)
        text = (folder / "msg" / f"{own}.msg").read_text(encoding="utf-8")
        inner = [
            f"{each.type.package or package}/{each.type.name}"
            for section in parse_definition(text, "msg").sections
            for each in section.fields
            if not each.type.is_primitive
        ]
        return text, inner

    try:
        return _joined(name.replace("/msg/", "/"), part)
    except (OSError, ValueError):
        return ""


def _joined(name: str, part: Callable[[str], Part]) -> str:
    text, inner = part(name)
    texts, waiting, seen = [text], list(inner), {name}
    while waiting:
        each = waiting.pop(0)
        if each in seen:
            continue
        seen.add(each)
        text, inner = part(each)
        texts.append(f"{_LINE}\nMSG: {each}\n{text}")
        waiting += inner
    return _ended(texts)


def _ended(texts: Iterable[str]) -> str:
    return "\n".join(each.rstrip("\n") for each in texts) + "\n"


def _short(kind: ros.MessageType) -> str:
    return f"{package_of(kind)}/{kind.name}"
