"""The dissector's tables: which messages, what their filters are called, model text is data."""

import re
from pathlib import Path

import pytest
from generated import model_of
from lupa import lua52, lua54
from sweeps import sweep

from jausml.generation.artifact import has_valid_header
from jausml.generation.errors import GenerationError
from jausml.generation.rendering import render as render_artifacts
from jausml.language.metamodel.classes import jaus
from jausml.language.model import read_models
from jausml_generators.common.components import library_services, used_services
from jausml_generators.wireshark.target import TARGET, message_tables

HERE = Path(__file__).parent
MODELS = HERE.parents[1] / "models"
FILTER = re.compile(r"jaus\.[a-z][a-z0-9_]*(\.[a-z][a-z0-9_]*)*")
SETS = """<?xml version="1.0" encoding="UTF-8"?>
<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xmlns:jaus="http://www.jausml.org/jaus/1.0" name="own">{}</jaus:ServiceSet>
"""
SERVICE = """
 <services name="{urn}" urn="{urn}"><inputs name="SetSpeed" code="0x0E00">
  <body xsi:type="jaus:Record" name="Rec" presenceVector="none">
   <fields xsi:type="jaus:FixedField" name="Speed" type="{kind}" optional="true"/>
  </body></inputs></services>
"""


@pytest.fixture(scope="module")
def example():
    return model_of(MODELS / "catvehicle" / "catvehicle.xmi")


def tables(path: Path):
    return message_tables(model_of(path).instances(jaus.Service))


def own(folder: Path, *services: str):
    path = folder / "own.xmi"
    path.write_text(SETS.format("".join(services)), encoding="utf-8")
    return tables(path)


def render(model, target=TARGET):
    (artifact,) = render_artifacts(model, [target])
    return artifact


def nodes(table):
    """Yields all tables inside a body."""
    if isinstance(table, dict):
        if "filter" in table:
            yield table
        table = list(table.values())
    for node in table if isinstance(table, list) else ():
        yield from nodes(node)


def test_the_system_decides_which_messages_are_known(example):
    names = {message.name for message in message_tables(used_services(example))}
    library = {message.name for message in message_tables(library_services())}

    assert {"SetWrenchEffort", "ReportVelocityState"} < names  # of its services
    assert {"QueryHeartbeatPulse", "ReportServices", "SetTime"} < names  # of the core
    assert names < library
    assert "SetJointEffort" in library - names


def test_all_knows_every_message_of_the_library(example):
    text = render(example, TARGET.for_whole_library()).text

    defined = {
        m.name
        for m in read_models(sorted((MODELS / "library/jaus").glob("*.xmi"))).model.instances(
            jaus.MessageDef
        )
    }
    assert len(defined) > 300
    assert all(f'    name = "{name}",\n    filter = ' in text for name in defined)


def test_filters_are_valid_and_of_one_type_each():
    types: dict[str, set[str]] = {}
    for message in message_tables(library_services()):
        assert FILTER.fullmatch(message.filter)
        for node in nodes(message.body):
            assert FILTER.fullmatch(node["filter"])
            shown = "double" if "scale" in node else node.get("type", node.get("kind", "bits"))
            types.setdefault(node["filter"], set()).add(shown)
    kinds = {
        filter_name: type_set - {"record", "list", "bits"}
        for filter_name, type_set in types.items()
    }
    assert not {name: type_set for name, type_set in kinds.items() if len(type_set) > 1}


def test_filters_are_made_of_the_names(example):
    messages = {m.name: m for m in message_tables(used_services(example))}
    (effort, *_) = messages["SetWrenchEffort"].body["fields"]

    assert effort["filter"] == "jaus.set_wrench_effort.propulsive_linear_effort_x"
    assert effort["scale"] == [-100.0, 200.0 / 65535]
    (velocity, *_) = messages["ReportVelocityState"].body["fields"]
    assert velocity["units"] == "meter per second"
    services = list(nodes(messages["ReportServices"].body))
    assert "jaus.report_services.node_list.node_rec.node_id" in {n["filter"] for n in services}


def test_equal_definitions_are_one_with_two_services(tmp_path):
    (message,) = own(
        tmp_path,
        SERVICE.format(urn="urn:a", kind="uint8"),
        SERVICE.format(urn="urn:b", kind="uint8"),
    )

    assert message.services == ["urn:a 1.0", "urn:b 1.0"]


def test_definitions_whose_filters_differ_in_type_have_two_names(tmp_path):
    first, second = own(
        tmp_path,
        SERVICE.format(urn="urn:a", kind="uint8"),
        SERVICE.format(urn="urn:b", kind="float32"),
    )

    assert (first.filter, second.filter) == ("jaus.set_speed", "jaus.set_speed_2")
    assert (first.name, second.name) == ("SetSpeed", "SetSpeed")


def test_without_a_presence_vector_no_member_is_optional(tmp_path):
    (message,) = own(tmp_path, SERVICE.format(urn="urn:a", kind="uint8"))

    assert "presence_bit" not in message.body["fields"][0]


def test_members_are_there_by_bits_that_count_from_0(tmp_path):
    field = '   <fields xsi:type="jaus:FixedField" name="{}" type="uint8" optional="{}"/>\n'
    fields = "".join(
        field.format(name, optional)
        for name, optional in (("First", "true"), ("Always", "false"), ("Second", "true"))
    )
    service = SERVICE.format(urn="urn:a", kind="uint8").replace(
        'presenceVector="none">\n', f'presenceVector="uint8">\n{fields}'
    )
    (message,) = own(tmp_path, service)
    bits = [field_table.get("presence_bit") for field_table in message.body["fields"]]
    assert bits == [0, None, 1, 2]


def test_a_message_that_contains_itself_is_refused(tmp_path):
    loop = """
 <types xsi:type="jaus:Record" xmi:id="R" name="R">
  <fields xsi:type="jaus:TypeReference" name="again" target="R"/></types>
 <services name="S" urn="urn:s"><inputs name="M" code="0x0E00">
  <body xsi:type="jaus:TypeReference" name="Body" target="R"/></inputs></services>"""
    with pytest.raises(GenerationError, match=r"M\.Body\.again: it contains itself"):
        own(tmp_path, loop)


def test_names_of_the_model_are_data():
    messages = tables(HERE / "hostile_messages.xmi")

    for message in messages:
        assert message.name.isprintable()
        for node in nodes(message.body):
            assert node["name"].isprintable() or "\U0001f600" in node["name"]
            assert FILTER.fullmatch(node["filter"])
    filters = [node["filter"] for node in messages[0].body["fields"]]
    assert len(filters) == len(set(filters))


def test_of_two_names_of_one_value_the_first_is_shown():
    first = tables(HERE / "hostile_messages.xmi")[0]
    (names,) = (n["names"] for n in nodes(first.body) if "names" in n and 2 in n["names"])

    assert names[2] == "MRO"


def test_the_file_is_lua_with_a_header_and_the_same_each_time(example):
    artifact = render(example)

    assert artifact.path == "wireshark/catvehicle_jaus.lua"
    assert artifact.text.startswith("-- Generated by jausml ")
    assert has_valid_header(artifact.text)
    assert not has_valid_header(artifact.text.replace("3794", "3795"))
    assert artifact.text == render(example).text
    assert artifact.text.isascii()
    assert "local PORTS = { 3794 }" in artifact.text


@pytest.mark.parametrize("lua", [lua52, lua54], ids=["5.2", "5.4"])
@pytest.mark.parametrize("whole_library", sweep([False, True], every=2), ids=["used", "all"])
def test_the_languages_of_old_and_new_wireshark_read_it(example, lua, whole_library):
    artifact = render(example, TARGET.for_whole_library() if whole_library else TARGET)
    load = lua.LuaRuntime(unpack_returned_tuples=True).globals().load

    assert isinstance(load("local x = "), tuple)  # what is no Lua is told with an error
    assert not isinstance(load(artifact.text), tuple)


def test_integers_that_count_from_a_lower_limit_show_their_value():
    message = next(table for table in tables(HERE / "every_kind.xmi") if table.name == "Offsets")
    year, gear, flags, *_ = message.body["fields"]
    assert (year["type"], year["offset"]) == ("uint8", 2000)
    assert gear["some_names"] == {-5: "reverse", 3: "forward"}
    assert flags["parts"][1]["offset"] == 10
