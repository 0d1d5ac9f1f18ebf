"""Rules about the headers of ROS messages: time and frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.paths.directions import directions
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.language.semantics.paths.scopes import parse_path, target_paths
from jausml.language.validation.rule import Finding, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.subject import Subject

_HEADER = "std_msgs/Header"
_PARTS = ("stamp", "frame_id")


@rule("JML460", Severity.WARNING, "header without time or frame")
def headers_filled(subject: Subject) -> Iterator[Finding]:
    """A ROS message with a header gets its stamp and its frame_id, or leaves them out on purpose.

    A stamp of 0 lies in 1970, and tf2 transforms nothing that has no frame: subscribers drop such a
    message or, even worse, use it.

    Bad: a map to nav_msgs/Odometry whose assignments do not name header

    Good: `header.stamp` by the clock or from the TimeStamp, and a constant for `header.frame_id`
    """
    for direction in directions(subject):
        owner = direction.owner
        if not direction.to_ros or not isinstance(owner, bridge.AttributeMap):
            continue
        if not owner.toRos or not subject.is_intact(owner, *owner.toRos):
            continue
        header = next((each for each in direction.map.type.fields if _is_header(each)), None)
        if header is None:
            continue
        assigned = {parse_path(path) for each in owner.toRos for path in target_paths(each)}
        names = [
            f"{header.name}.{part}"
            for part in _PARTS
            if not assigned & {(header.name,), (header.name, part)}
            and not any(path[:2] == (header.name, part) for path in assigned)
        ]
        if names:
            message = f"map '{owner.name}' gives {' and '.join(names)} no value"
            yield Finding(owner, message, "toRos", "assign it, or add an Ignore")


@rule("JML461", Severity.ERROR, "frame id with a slash in front")
def frame_ids(subject: Subject) -> Iterator[Finding]:
    """The id of a frame does not begin with a slash, because tf2 refuses such ids.

    Bad: `target="header.frame_id" value="/odom"`

    Good: `target="header.frame_id" value="odom"`
    """
    for direction in directions(subject):
        if not direction.to_ros:
            continue
        for placed in direction.of_kind(bridge.ConstantAssignment):
            constant = placed.assignment
            last = (constant.target or "").strip().rpartition(".")[2]
            if last.endswith("frame_id") and (constant.value or "").startswith("/"):
                message = f"frame id '{constant.value}' begins with a slash"
                yield Finding(constant, message, "value", f"write {constant.value.lstrip('/')}")


def _is_header(field: ros.Field) -> bool:
    kind = field.messageType if isinstance(field, ros.MessageField) else None
    return kind is not None and field.arrayKind.name == "single" and ros_name(kind) == _HEADER
