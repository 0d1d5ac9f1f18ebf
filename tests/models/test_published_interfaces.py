"""Interfaces of packages that no wheel has, field by field against the published definitions.

`published_interfaces.json` holds facts read from the repositories of these packages: the lines of
each definition without its comments. It was not read by the importer that made the library.

    ackermann_msgs   ros-drivers/ackermann_msgs, branch ros2, version 2.0.2
    control_msgs     ros-controls/control_msgs, branch jazzy, version 5.8.0
    geographic_msgs  ros-geographic-info/geographic_info, branch ros2, version 1.0.5
    nav2_msgs        ros-navigation/navigation2, branch jazzy, version 1.3.13; FollowPath from the
                     versions before and after it, which have these fields in common
"""

import json
from pathlib import Path

from for_each import for_each

from jausml.language.metamodel.classes import ros
from jausml.language.model import library_root, read_models

HERE = Path(__file__).parent
PUBLISHED = json.loads((HERE / "published_interfaces.json").read_text(encoding="utf-8"))
SIZES = {"fixedArray": "[{}]", "unboundedSequence": "[]", "boundedSequence": "[<={}]", "single": ""}


def line_of(field: ros.Field, package: str) -> str:
    """Returns a field as definitions have it, types of its own package without that."""
    if isinstance(field, ros.MessageField):
        owner = field.messageType.eContainer().name
        name = field.messageType.name
        base = name if owner == package else f"{owner}/{name}"
    else:
        base = field.type.name
    size = SIZES[field.arrayKind.name].format(field.arraySize)
    default = None if isinstance(field, ros.MessageField) else field.defaultValue
    return " ".join(filter(None, [f"{base}{size}", field.name, default]))


def types_of(package: ros.InterfacePackage) -> dict[str, ros.MessageType]:
    parts = [message_type for s in package.services for message_type in (s.request, s.response)]
    parts += [
        message_type for a in package.actions for message_type in (a.goal, a.result, a.feedback)
    ]
    return {message.name: message for message in (*package.messages, *parts)}


@for_each("package", PUBLISHED)
def test_fields_are_the_published_ones(package):
    path = library_root() / "ros" / f"{package}.xmi"
    (root,) = (e for e in read_models([path]).model.roots if e.name == package)
    found = {}
    for name, kind in types_of(root).items():
        constants = [
            f"{constant.type.name} {constant.name}={constant.value}" for constant in kind.constants
        ]
        found[name] = sorted(constants), [line_of(field, package) for field in kind.fields]
    expected = {}
    for name, lines in PUBLISHED[package].items():
        own = [line.replace(f"{package}/", "") for line in lines]
        constants = sorted(line for line in own if "=" in line.replace("<=", ""))
        expected[name] = constants, [line for line in own if line not in constants]
    assert found == expected
