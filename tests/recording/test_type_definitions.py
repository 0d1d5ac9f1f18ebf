"""Definitions of ROS types in recordings: others understand them, and say what models say."""

import pytest
from rosbags.typesys import get_types_from_msg

from jausml.language.interfaces import Installation
from jausml.language.metamodel.classes import ros
from jausml.language.model import library_root, read_models
from jausml.live.recording.schemas import full_name, installed_definition, modelled_definition


@pytest.fixture(scope="module")
def types():
    """The message types of the library, those of services and actions left out."""
    files = sorted((library_root() / "ros").glob("*.xmi"))
    found = read_models(files).model.instances(ros.MessageType)
    return [kind for kind in found if isinstance(kind.eContainer(), ros.InterfacePackage)]


def fields(text, name):
    """What rosbags understands of a definition: names and types of all fields."""
    return {key: value[1] for key, value in get_types_from_msg(text, name).items()}


def test_definitions_of_all_types_of_the_library_are_understood(types):
    assert len(types) > 50
    for message_type in types:
        found = fields(modelled_definition(message_type), full_name(message_type))
        assert [name for name, _ in found[full_name(message_type)]] == [
            str(f.name) for f in message_type.fields
        ]


@pytest.mark.needs("interfaces")
def test_installed_definitions_say_the_same(types):
    installation = Installation()
    compared = 0
    for message_type in types:
        name = full_name(message_type)
        installed = installed_definition(name, installation)
        if installed:
            assert fields(installed, name) == fields(modelled_definition(message_type), name)
            compared += 1
    assert compared


def test_type_that_is_not_installed_has_no_definition():
    assert installed_definition("no_such_msgs/msg/Thing", Installation()) == ""
    assert installed_definition("std_msgs/msg/../../Thing", Installation()) == ""
