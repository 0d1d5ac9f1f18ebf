"""Every installed interface, as we read it, is what the classes that rosidl generated say."""

from __future__ import annotations

import importlib
import json

import pytest

from jausml.importers.ros import import_packages, installed_source
from jausml.interfaces import Installation

PACKAGES = [each for each in Installation().packages() if each != "rmw_dds_common"]
"""All but one whose Python classes are not installed."""

NAMES = {
    "bool": "boolean",
    "byte": "octet",
    "char": "uint8",
    "float32": "float",
    "float64": "double",
}

pytestmark = pytest.mark.skipif(
    "geometry_msgs" not in PACKAGES, reason="no ROS message packages in this environment"
)


@pytest.fixture(scope="module")
def imported():
    installation = Installation()
    folders = {each: installation.folder(each) for each in PACKAGES}
    sources = [installed_source(name, folder) for name, folder in folders.items()]
    result = import_packages(sources, library=False)
    assert result.diagnostics == []
    return {package.name: package for package in result.packages}


@pytest.mark.parametrize("name", PACKAGES)
def test_package(imported, name):
    package = imported[name]
    checked = 0
    for message in package.messages:
        checked += compare(message, getattr(importlib.import_module(f"{name}.msg"), message.name))
    for service in package.services:
        cls = getattr(importlib.import_module(f"{name}.srv"), service.name)
        checked += compare(service.request, cls.Request)
        checked += compare(service.response, cls.Response)
    assert checked == len(package.messages) + 2 * len(package.services)


def compare(message, cls):
    """Holds fields, types, defaults and constants of a message against its class."""
    theirs = dict(cls.get_fields_and_field_types())
    # A message without fields has a dummy member, which Python hides.
    theirs.pop("structure_needs_at_least_one_member", None)
    assert {field.name: slot_type(field) for field in message.fields} == theirs
    assert [field.name for field in message.fields] == list(theirs)
    default = cls()
    for field in message.fields:
        stated = getattr(field, "defaultValue", None)
        if stated is not None:
            assert value_of(stated, field.type.name) == getattr(default, field.name)
    for constant in message.constants:
        theirs = getattr(cls, constant.name)
        theirs = theirs[0] if isinstance(theirs, bytes) else theirs
        assert value_of(constant.value, constant.type.name) == theirs
    return 1


def slot_type(field):
    """Returns the type of a field as rosidl's Python classes name it."""
    if field.eClass.name == "MessageField":
        base = f"{field.messageType.eContainer().name}/{field.messageType.name}"
    else:
        base = NAMES.get(field.type.name, field.type.name)
        base += f"<{field.stringBound}>" if field.stringBound else ""
    return {
        "single": base,
        "fixedArray": f"{base}[{field.arraySize}]",
        "boundedSequence": f"sequence<{base}, {field.arraySize}>",
        "unboundedSequence": f"sequence<{base}>",
    }[field.arrayKind.name]


def value_of(text, kind):
    return text if "string" in kind else json.loads(text)
