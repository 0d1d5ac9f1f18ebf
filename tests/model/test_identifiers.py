"""Ids that elements get from their names."""

from jausml.language.model import read_models
from jausml.language.model.xmi.writer import name_identifiers

TEXT = """<?xml version="1.0" encoding="UTF-8"?>
<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xmlns:jaus="http://www.jausml.org/jaus/1.0" name="set">
 <types xsi:type="jaus:Record" name="Shared"><fields xsi:type="jaus:FixedField" name="a"/></types>
 <types xsi:type="jaus:Record" name="Unused"><fields xsi:type="jaus:FixedField" name="b"/></types>
 <services name="One" urn="u:1"><inputs name="Set" code="0x0001"/></services>
 <services xmi:id="kept" name="Two" urn="u:2"><inputs name="Set" code="0x0002">
  <body xsi:type="jaus:TypeReference" name="Body" target="//@types.0"/>
 </inputs></services>
 <services name="two words" urn="u:3"><inputs name="Set" code="0x0003"/></services>
 <services name="Same" urn="u:4"/>
 <services name="Same" urn="u:5"/>
</jaus:ServiceSet>
"""


def test_ids_are_the_names_by_which_people_call_elements(tmp_path):
    path = tmp_path / "set.xmi"
    path.write_text(TEXT, encoding="utf-8")
    result = read_models([path], project_root=tmp_path)
    assert not result.has_errors
    model = result.model
    name_identifiers([model.root], model)
    services = model.root.services
    ids = [model.identifier(service) for service in services]
    assert ids == ["One", "kept", None, "Same", None]
    messages = [model.identifier(service.inputs[0]) for service in services[:3]]
    assert messages == ["One.Set", "Two.Set", None]
    assert [model.identifier(data_type) for data_type in model.root.types] == ["Shared", None]
    assert model.identifier(model.root) is None
