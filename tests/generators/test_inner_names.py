"""Names of the classes inside of a message: plain ones, and qualified ones where they clash."""

from enum import IntEnum
from pathlib import Path

from .codec_support import load, read_messages, render

MODEL = """<?xml version="1.0" encoding="UTF-8"?>
<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:jaus="http://www.jausml.org/jaus/1.0" name="samples">
  <services name="Sampler" urn="urn:samples:Sampler">
    <outputs name="ReportSamples" code="0xD001">
      <body xsi:type="jaus:Sequence" name="Body">
        <fields xsi:type="jaus:Record" name="Sampler">
          {sampler}
        </fields>
        <fields xsi:type="jaus:Record" name="Drill">
          {drill}
          <fields xsi:type="jaus:BitField" name="Flags" type="uint8">
            <subFields name="State" lowBit="0" highBit="1">{flags}</subFields>
          </fields>
        </fields>
      </body>
    </outputs>
  </services>
</jaus:ServiceSet>
"""


def listed(*values: str) -> str:
    rows = "".join(
        f'<values xsi:type="jaus:EnumeratedValue" name="{name}" value="{number}"/>'
        for number, name in enumerate(values)
    )
    return f"<values>{rows}</values>"


def integer(name: str, *values: str) -> str:
    return (
        f'<fields xsi:type="jaus:FixedField" name="{name}" type="uint8">{listed(*values)}</fields>'
    )


def enumerations(folder: Path, sampler: str, drill: str, *flags: str) -> dict[str, list[str]]:
    """Returns the constants of the enumerations of the message by class name."""
    path = folder / "samples.xmi"
    path.write_text(MODEL.format(sampler=sampler, drill=drill, flags=listed(*flags)))
    message = load(render(read_messages(path)), "inner_names").ReportSamples
    assert message.decode(message().encode()) == message()
    return {
        name: [int_enum.name for int_enum in item]
        for name, item in vars(message).items()
        if isinstance(item, type) and issubclass(item, IntEnum)
    }


def test_one_class_for_equal_values_has_the_name_of_the_field(tmp_path):
    state = integer("State", "idle", "busy")
    assert enumerations(tmp_path, state, state, "idle", "busy") == {"State": ["IDLE", "BUSY"]}


def test_a_clash_is_told_apart_by_the_enclosing_record_or_bit_field(tmp_path):
    first, second = integer("State", "idle", "busy"), integer("State", "up", "down")
    assert enumerations(tmp_path, first, second, "off", "on") == {
        "State": ["IDLE", "BUSY"],
        "DrillState": ["UP", "DOWN"],
        "FlagsState": ["OFF", "ON"],
    }


def test_names_that_the_module_uses_itself_are_qualified(tmp_path):
    found = enumerations(tmp_path, integer("Message", "none", "some"), "", "off", "on")
    assert set(found) == {"SamplerMessage", "State"}


def test_a_qualified_name_that_is_taken_too_gets_a_number(tmp_path):
    first = integer("State", "idle") + integer("DrillState", "far", "near")
    found = enumerations(tmp_path, first, integer("State", "up", "down"), "off", "on")
    assert set(found) == {"State", "DrillState", "DrillState2", "FlagsState"}
