"""Every installed interface, as we read it, is what the classes that rosidl generated say."""

import importlib
import json
import re

import needs
import pytest

from jausml.language.importers.ros import import_packages, installed_source
from jausml.language.interfaces import Installation, parse_definition
from jausml.language.interfaces.parsing import definition_files

PACKAGES = [package for package in Installation().packages() if package != "rmw_dds_common"]
"""All but one whose Python classes are not installed."""

NAMES = {
    "bool": "boolean",
    "byte": "octet",
    "char": "uint8",
    "float32": "float",
    "float64": "double",
}

pytestmark = pytest.mark.needs("interfaces")


@pytest.fixture(scope="module")
def imported():
    installation = Installation()
    folders = {package: installation.folder(package) for package in PACKAGES}
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


def test_comments_and_units_are_those_that_rosidl_finds():
    needs.ask("rosidl")
    from rosidl_adapter import parser

    installation = Installation()
    paths = [file for name in PACKAGES for file in definition_files(installation.folder(name))]
    compared = 0
    for path in (definition_file for definition_file in paths if definition_file.suffix == ".msg"):
        text = path.read_text(encoding="utf-8")
        (ours,) = parse_definition(text, "msg").sections
        theirs = parser.parse_message_string("any_msgs", "M", text)
        pairs = [(ours, theirs), *zip(ours.constants, theirs.constants, strict=True)]
        for mine, field in zip(ours.fields, theirs.fields, strict=True):
            pairs.append((mine, field))
            assert mine.units == field.annotations.get("unit", "")
        for mine, other in pairs:
            compared += 1
            comment = "\n".join(other.annotations.get("comment", []))
            assert plain(mine.comment) == plain(comment), path
    assert compared > 500


def plain(comment):
    """Returns the lines of a comment without units, which rosidl takes out, and blank ones."""
    lines = re.sub(r"\s*\[[^\]]*\]", "", comment).splitlines()
    return [line.strip() for line in lines if line.strip()]
