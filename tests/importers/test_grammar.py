"""Each element and attribute of AS5684 1.0 and 1.1 is imported, or refused with its reason."""

import re
from pathlib import Path

import pytest
from for_each import for_each
from jsidl_support import WINCH, constants, good, marked, record, run, service
from lxml import etree

from jausml.language.exporters.jsidl import export_jsidl
from jausml.language.importers.jsidl.vocabulary import CONTAINERS, FIELDS, VOCABULARY
from jausml.language.metamodel.classes import jaus

GUARDS = ("docs/reference/jsidl.md",)
PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "jsidl.md"

COUNT = '<count_field field_type_unsigned="unsigned byte"/>'
ON_OFF = (
    '<value_set{} offset_to_lower_limit="false"><value_enum enum_index="0" enum_const="OFF"/>'
    '<value_enum enum_index="1" enum_const="ON"/></value_set>'
)
ON_OFF_REF = '<declared_value_set name="v" declared_type_ref="OnOff" interpretation="Of a lamp."/>'
OPTIONAL = ' optional="false"'
NUMBER = 'field_type="unsigned byte" field_units="one"'
REC = f'<record name="R"{OPTIONAL}><fixed_field name="A" {NUMBER}{OPTIONAL}/></record>'

# Attributes and insides of each field and container; {} stands for its values.
KINDS = {
    "fixed_field": f"{NUMBER}|{{}}",
    "variable_field": "|<type_and_units_field>"
    f'<type_and_units_enum name="A" index="0" {NUMBER}>{{}}</type_and_units_enum>'
    "</type_and_units_field>",
    "bit_field": 'field_type_unsigned="unsigned byte"|'
    '<sub_field name="L"><bit_range from_index="2" to_index="2"/>{}</sub_field>',
    "fixed_length_string": 'string_length="4"|',
    "variable_length_string": f"|{COUNT}",
    "variable_length_field": f'field_format="JPEG"|{COUNT}',
    "variable_format_field": '|<format_field><format_enum index="0" field_format="JPEG"/>'
    f"</format_field>{COUNT}",
    "array": f'|<fixed_field name="A" {NUMBER}{OPTIONAL}/><dimension name="D" size="3"/>',
    "record": f'|<fixed_field name="A" {NUMBER}{OPTIONAL}/>',
    "sequence": f"|{REC}",
    "list": f"|{COUNT}{REC}",
    "variant": f'|<vtag_field field_type_unsigned="unsigned byte"/>{REC}',
}


def written(kind, name, values):
    attributes, _, inside = KINDS[kind].partition("|")
    return f'<{kind} name="{name}"{OPTIONAL} {attributes}>{inside.format(values)}</{kind}>'


def around(kind, field):
    """Returns a body with a field."""
    return field if kind in CONTAINERS else record(field)


def exported(made):
    """Returns a service as JSIDL, without what is said beside the values."""
    result = run(service())
    (text,) = export_jsidl(result.model, [made]).documents.values()
    return re.sub(rb' interpretation="[^"]*"', b"", text)


@for_each("kind", KINDS)
def test_a_declared_type_is_what_it_stands_for_and_comes_back(kind):
    named = written(kind, "T", ON_OFF_REF)
    if ON_OFF_REF in named:
        named += ON_OFF.format(' name="OnOff"')
    use = f'<declared_{kind} name="F" declared_type_ref="T"{OPTIONAL}/>'
    by_name = good(service(around(kind, use), named))
    inline = good(service(around(kind, written(kind, "F", ON_OFF.format("")))))
    assert exported(by_name) == exported(inline)
    assert b'"F"' in exported(by_name)


@pytest.mark.parametrize("kind", ["fixed_field", "variable_field", "bit_field"])
def test_values_that_are_declared_once_are_those_of_each_field(kind):
    made = good(service(record(written(kind, "F", ON_OFF_REF)), ON_OFF.format(' name="OnOff"')))
    (field,) = made.inputs[0].body.fields
    part = field
    if not isinstance(field, jaus.FixedField):
        (part,) = field.subFields if kind == "bit_field" else field.alternatives
    assert [(value.name, value.value) for value in part.values.values] == [("OFF", 0), ("ON", 1)]
    assert part.documentation == "Of a lamp."


def test_declared_values_that_are_missing_or_no_values_are_told():
    field = written("fixed_field", "F", '<declared_value_set name="v" ⟦{}⟧declared_type_ref="{}"/>')
    marked(service(record(field.format("JML608", "Onoff")), ON_OFF.format(' name="OnOff"')))
    other = f'<fixed_field name="Other" {NUMBER}{OPTIONAL}/>'
    marked(service(record(field.format("JML609", "Other")), other))
    unused = '⟦JML604⟧<value_set name="None"/>'
    marked(service(record(other), unused))


def test_what_is_deprecated_is_said_in_its_documentation():
    text = service(REC).replace("<message_def", '<message_def deprecated="true"', 1)
    text = text.replace("<event_def", '<event_def deprecated="true"')
    made = good(text.replace("<service_def", '<service_def deprecated="true"'))
    assert made.documentation == "Deprecated. Gives light."
    assert [message.documentation for message in made.inputs] == ["Deprecated.", None]
    assert made.events[0].documentation == "Deprecated."


def test_each_element_and_attribute_stands_in_the_reference():
    page = PAGE.read_text(encoding="utf-8")
    told = set(re.findall(r"`([a-z_]+)`", page))
    assert VOCABULARY.keys() - told == set()
    assert {name for rule in VOCABULARY.values() for name in rule.attributes} - told == set()
    assert told <= {
        *VOCABULARY,
        *(name for rule in VOCABULARY.values() for name in rule.attributes),
    }


def test_each_element_is_tried_by_these_tests_or_by_the_winch():
    tags = {etree.QName(e).localname for path in WINCH for e in etree.parse(path).iter("{*}*")}
    tags |= {f"declared_{kind}" for kind in KINDS} | {"declared_value_set", "service_set"}
    assert set(KINDS) == {*FIELDS, *CONTAINERS, "array"}
    missing = VOCABULARY.keys() - tags
    assert missing == {"declared_body", "declared_footer", "declared_event_def"}


def test_parts_of_messages_and_events_are_declared_too():
    types = f'<body name="B">{REC}</body><footer name="E"/><event_def name="Ev"/>'
    text = service(types=types).replace(
        '<body name="Body">\n          \n        </body>',
        '<declared_body name="Body" declared_type_ref="B"/>'
        '<declared_footer name="Footer" declared_type_ref="E"/>',
    )
    event = '<declared_event_def name="Burnt" declared_type_ref="Ev"/>'
    made = good(text.replace('<event_def name="Burnt"/>', event))
    assert [field.name for field in made.inputs[0].body.fields] == ["A"]
    assert [declared_event.name for declared_event in made.events] == ["Burnt"]


def test_constants_of_each_type_count_and_texts_are_none():
    types = ("byte", "unsigned long integer", "long float", "string")
    values = ("1", "2", "0.5", "four")
    given = "".join(
        f'<const_def name="C{n}" const_type="{kind}" const_value="{value}" field_units="one"/>'
        for n, (kind, value) in enumerate(zip(types, values, strict=True))
    )
    reference = '<declared_const_set_ref name="c" id="urn:example:light:Constants" version="1.0"/>'
    text = '<fixed_length_string name="F" string_length="{}" optional="false"/>'
    total = text.format("c.C0 + c.C1 * c.C2 + 2")
    (field,) = good(service(record(total), reference), constants(given)).inputs[0].body.fields
    assert field.length == 4
    broken = record(text.format("c.C3").replace("string_length", "⟦JML605⟧string_length"))
    (found,) = marked(service(broken, reference), constants(given))
    assert "whose value has an unknown constant" in found.message
