"""Explanations of names that mean nothing in a text: what nobody imported or declared."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from jausml.language.model.notation import Explanation
from jausml.language.model.uris import library_root
from jausml.language.text.reading.library_maps import library_maps

_DECLARED = ("jaus.MessageDef", "ros.MessageType")
_NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")

if TYPE_CHECKING:
    from jausml.language.text.reading.declaring.messages import OwnService


def explain(qualified_class: str, name: str, service: OwnService) -> Explanation:
    """Returns what to write where a name means nothing."""
    if qualified_class == "bridge.AttributeMap":
        wanted = name.rpartition(".")[2]
        modules = [each.module for each in library_maps() if each.name == wanted]
        imports = " or ".join(f"import {each}" for each in modules)
        return Explanation(f"the library has it: {imports}" if imports else "", bool(imports))
    if qualified_class == "jaus.Service" and service.node is not None and service.written is None:
        hint = f"the messages of this file belong to '{service.name}', named after the file"
        return Explanation(f"{hint}: 'service {name}' gives it a name that stays")
    if qualified_class in _DECLARED and not _NAME.fullmatch(name.rpartition("/")[2]):
        hint = "the name of a new one has letters from A to z, digits and underscores"
        return Explanation(f"{hint}, with a letter first")
    if qualified_class == "jaus.MessageDef":
        hint = f"list its members to declare it: {name} ( uint16 x )"
        return Explanation(f"{hint}; jausml import jsidl reads service sets")
    package, _, type_name = name.replace("/msg/", "/").rpartition("/")
    is_shipped = bool(package) and (library_root() / "ros" / f"{package}.xmi").is_file()
    if qualified_class == "ros.MessageType" and not is_shipped:
        hint = f"list its members to declare it: {package or 'my_msgs'}/{type_name} ( float64 x )"
        return Explanation(f"{hint}; jausml import ros reads packages")
    return Explanation()
