"""Core services that components provide though their models do not name them."""

import pytest
from generated import model_in

from jausml.language.metamodel.classes import jaus, system
from jausml.language.validation.engine import check_project
from jausml_generators.common.components import component_settings, service_identities

CORE_1_1 = {"Transport", "Events", "Discovery", "Liveness", "AccessControl", "Management"}


def identities(component):
    """Versions by names of services."""
    found = {}
    for text in service_identities(component):
        urn, major, minor = text.removeprefix("ServiceIdentity(").removesuffix(")").split(", ")
        found[urn.strip('"').rpartition(":")[2]] = f"{major}.{minor}"
    return found


def provided(folder, features, imports=""):
    model = model_in(folder, f"{imports}\ncomponent a {{ address: 1.1.1 {features} }}")
    [component] = model.instances(jaus.Component, library=False)
    return identities(component)


def test_a_component_that_names_none_has_those_of_core_1_1(tmp_path):
    assert provided(tmp_path, "") == dict.fromkeys(CORE_1_1, "1.1")


@pytest.mark.parametrize("word", ["coreServices: none", "external: true"])
def test_one_word_leaves_them_out(tmp_path, word):
    found = provided(tmp_path, f"provides: VelocityStateSensor {word}")
    assert found == dict.fromkeys(("Transport", "Events", "VelocityStateSensor"), "1.0")


def test_what_is_inherited_keeps_its_version_and_is_not_doubled(tmp_path):
    found = provided(tmp_path, "provides: PrimitiveDriver")
    assert found.pop("PrimitiveDriver") == "1.0"
    inherited = {"Transport", "Events", "AccessControl", "Management"}
    assert {name for name, version in found.items() if version == "1.0"} == inherited
    assert {name for name, version in found.items() if version == "1.1"} == CORE_1_1 - inherited


def test_what_is_named_keeps_its_version(tmp_path):
    found = provided(tmp_path, "provides: Discovery, Liveliness", "import `jaus.core-1.0`")
    assert found["Discovery"] == found["Liveliness"] == found["Events"] == "1.0"
    assert found["Management"] == "1.1"
    assert "Liveness" not in found


def test_a_bridge_has_them_too(tmp_path):
    text = (
        "import mappings.velocity_state_sensor\n"
        "bridge b { address: 1.1.1 provides: VelocityStateSensor"
        " connection c { map: velocity_state topic t } }"
    )
    [bridge] = model_in(tmp_path, text).instances(jaus.Component, library=False)
    assert set(identities(bridge)) > CORE_1_1


@pytest.mark.parametrize(
    ("components", "answering"),
    [
        ({"1.1.1": "", "1.1.2": ""}, ["1.1.1"]),
        ({"1.2.7": "", "1.10.3": ""}, ["1.2.7"]),
        ({"1.1.1": "coreServices: none", "1.1.2": ""}, ["1.1.2"]),
        ({"1.1.5": "external: true", "1.1.2": ""}, []),
        ({"1.1.5": "external: true", "1.1.1": ""}, ["1.1.1"]),
        ({"1.1.7": "", "2.1.9": ""}, ["1.1.7", "2.1.9"]),
    ],
)
def test_one_component_answers_for_its_subsystem(tmp_path, components, answering):
    named = [
        f"component c{number} {{ address: {address} {features} }}"
        for number, (address, features) in enumerate(components.items())
    ]
    [whole] = model_in(tmp_path, "\n".join(named)).instances(system.System)
    found = [
        component.address
        for component in whole.components
        if "SUBSYSTEM" in component_settings(whole, component)
    ]
    assert found == answering


def test_own_messages_of_a_core_code_are_told_of(tmp_path):
    path = tmp_path / "model.xmi"
    path.write_text(
        """<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
        xmlns:jaus="http://www.jausml.org/jaus/1.0" xmlns:system="http://www.jausml.org/system/1.0"
        name="example">
          <serviceSets name="example">
            <services xmi:id="Lamp" name="Lamp" urn="urn:example:Lamp">
              <inputs name="QueryLamp" code="0x2002"/>
            </services>
          </serviceSets>
          <components name="lamp" address="1.1.1" provides="Lamp"/>
        </system:System>""",
        encoding="utf-8",
    )
    [finding] = check_project([path]).diagnostics
    assert finding.rule == "JML313"
    assert "QueryStatus" in finding.message
    assert "QueryLamp" in finding.message
    assert "coreServices" in finding.hint
    text = path.read_text(encoding="utf-8").replace("1.1.1", '1.1.1" coreServices="none')
    path.write_text(text, encoding="utf-8")
    assert [diagnostic.rule for diagnostic in check_project([path]).diagnostics] == ["JML357"]
