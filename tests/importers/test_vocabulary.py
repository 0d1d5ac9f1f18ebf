"""Every kind of field, names along references, numbers: what a service of JSIDL becomes."""

import pytest
from codec_strategies import messages
from codec_support import load, render
from for_each import for_each
from hypothesis import HealthCheck, given, settings
from jsidl_support import constants, good, record, run, service, type_set, winch

from jausml.language.model import read_models
from jausml.language.model.comparison import compare
from jausml.language.model.xmi.writer import write_model
from jausml_generators.python.codec.message_builder import build_messages


def fields(text, *others, types=""):
    """Imports fields of a record."""
    made = good(service(record(text), types), *others)
    return list(made.inputs[0].body.fields)


def fixed(content="", name="F", kind="unsigned byte"):
    head = f'<fixed_field name="{name}" field_type="{kind}" field_units="one" optional="false"'
    return f"{head}>{content}</fixed_field>" if content else f"{head}/>"


def scaled(lower, upper):
    limits = f'real_lower_limit="{lower}" real_upper_limit="{upper}"'
    return fixed(f'<scale_range {limits} integer_function="round"/>')


def test_the_service_with_every_kind_reads_back_and_opens_in_code(tmp_path):
    result = winch()
    assert not result.has_errors
    path = tmp_path / "winch.xmi"
    write_model(result.sets, result.model, path)
    read = read_models([path], project_root=tmp_path)
    assert read.diagnostics == []
    (ours,), theirs = result.sets, read.model.root
    assert compare(ours, theirs, result.model.metamodels) == []
    views = build_messages(m for s in theirs.services for m in (*s.inputs, *s.outputs))
    module = load(render(views), "imported_winch")
    assert {view.class_name for view in views} >= {"SetRope", "ReportRope", "StopWinch"}

    for view in views:
        hold_round_trip(view, getattr(module, view.class_name))


def hold_round_trip(view, cls):
    @settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))
    @given(message=messages(view, cls))
    def check(message):
        encoded = message.encode()
        assert cls.decode(encoded).encode() == encoded

    check()


def test_names_and_optionality_of_references_override_those_of_types():
    types = fixed(name="Speed", kind="unsigned short integer")
    declared = '<declared_fixed_field name="{}" declared_type_ref="Speed" optional="{}"/>'
    vector = '<presence_vector field_type_unsigned="unsigned byte"/>'
    members = fields(
        vector + declared.format("Top", "true") + declared.format("Low", "false"), types=types
    )
    rows = [(member.name, member.optional, member.type.name) for member in members]
    assert rows == [("Top", True, "uint16"), ("Low", False, "uint16")]


def test_types_are_found_through_sets_of_sets():
    inner = type_set(fixed(name="Speed", kind="long float"), identifier="urn:inner")
    outer = type_set(
        '<declared_type_set_ref name="in" id="urn:inner" version="1.0"/>', identifier="urn:outer"
    )
    reference = '<declared_type_set_ref name="out" id="urn:outer" version="1.0"/>'
    use = '<declared_fixed_field name="V" declared_type_ref="out.in.Speed" optional="false"/>'
    (field,) = fields(use, inner, outer, types=reference)
    assert (field.name, field.type.name) == ("V", "float64")


@for_each(
    ("text", "value"),
    [
        ("-8*c.PI", -8 * 3.25),
        ("3.14159265358979323846/2", 3.141592653589793 / 2),
        ("-(2 + 3) * -4 / 8", 2.5),
        ("10,000.5", 10000.5),
        ("1e-3", 0.001),
        (".5", 0.5),
        ("+ c.PI", 3.25),
        ("c . DOUBLE", 6.5),
        ("c.DOUBLE\n    - 1", 5.5),
    ],
)
def test_limits_are_expressions(text, value):
    sets = constants(
        '<const_def name="PI" const_type="float" const_value="3.25" field_units="one"/>'
        '<const_def name="DOUBLE" const_type="float" const_value="2*PI" field_units="one"/>'
    )
    reference = '<declared_const_set_ref name="c" id="urn:example:light:Constants" version="1.0"/>'
    (field,) = fields(scaled(text, "1e9"), sets, types=reference)
    assert field.scale.lower == value


def test_integers_of_64_bits_keep_their_last_digit():
    (field,) = fields(
        fixed(
            '<value_set offset_to_lower_limit="false">'
            '<value_enum enum_index="9223372036854775807" enum_const="TOP"/></value_set>',
            kind="unsigned long integer",
        )
    )
    assert field.values.values[0].value == 2**63 - 1


@pytest.mark.parametrize(("text", "is_offset"), [("true", True), ("false", False)])
def test_values_may_count_from_their_lower_limit(text, is_offset):
    (field,) = fields(
        fixed(
            f'<value_set offset_to_lower_limit="{text}"><value_range lower_limit="1000"'
            ' lower_limit_type="inclusive" upper_limit="1200" upper_limit_type="inclusive"/>'
            "</value_set>",
            kind="unsigned byte",
        )
    )
    assert field.values.offsetToLowerLimit is is_offset


def test_bounds_that_a_count_has_anyway_are_left_out():
    text = (
        '<variable_length_string name="S" optional="false">'
        '<count_field field_type_unsigned="unsigned byte" min_count="0" max_count="255"/>'
        "</variable_length_string>"
    )
    (field,) = fields(text)
    assert (field.minimumLength, field.maximumLength) == (0, 0)


def test_a_service_of_the_library_is_inherited():
    references = (
        '<references><inherits_from name="e" id="urn:jaus:jss:core:Events" version="1.*"/>'
        "</references>"
    )
    made = good(service(references=references))
    assert (made.inherits.name, made.inherits.version) == ("Events", "1.1")


def test_a_service_of_the_files_goes_before_one_of_the_library():
    base = service().replace("urn:example:light:Lamp", "urn:jaus:jss:core:Events")
    base = base.replace('version="1.0">', 'version="1.1">', 1).replace('"Lamp"', '"Events"', 1)
    references = (
        '<references><inherits_from name="e" id="urn:jaus:jss:core:Events" version="1.1"/>'
        "</references>"
    )
    result = run(base, service(references=references))
    assert not result.has_errors
    sets = {service_set.name: service_set for service_set in result.sets}
    assert sorted(sets) == ["core", "light"]
    (lamp,) = sets["light"].services
    assert lamp.inherits is sets["core"].services[0]
    assert [document.display for document in result.model.documents] == ["0.xml", "1.xml"]


def test_ids_are_unique_with_several_sets(tmp_path):
    other = service().replace("urn:example:light:Lamp", "urn:example:heat:Lamp")
    result = run(service(), other)
    path = tmp_path / "both.xmi"
    write_model(result.sets, result.model, path)
    read = read_models([path], project_root=tmp_path)
    assert read.diagnostics == []
    names = [read.model.fragment(s.inputs[0]) for root in read.model.roots for s in root.services]
    assert names == ["light.Lamp.SetLamp", "heat.Lamp.SetLamp"]


def test_versions_of_one_service_are_sets_of_their_own():
    later = service().replace('version="1.0">', 'version="2.0">', 1)
    result = run(service(), later)
    pairs = [(service_set.name, service_set.version) for service_set in result.sets]
    assert pairs == [("light", "1.0"), ("light", "2.0")]


def test_a_service_set_is_a_set():
    inner = service().partition("?>")[2]
    own = type_set("")
    text = (
        '<plus:service_set xmlns:plus="urn:jaus:jsidl:plus" name="Night Lights" id="x"'
        f' version="3.1" mxGraph="0"><plus:mxCell/>{own}{inner}</plus:service_set>'
    )
    result = run(text)
    assert result.diagnostics == [], [str(diagnostic) for diagnostic in result.diagnostics]
    assert [(service_set.name, service_set.version) for service_set in result.sets] == [
        ("night_lights", "3.1")
    ]
    named = run(text, name="own", version="9.9")
    assert [(service_set.name, service_set.version) for service_set in named.sets] == [
        ("own", "9.9")
    ]


def test_texts_of_the_author_are_kept():
    made = winch().sets[0].services[0]
    assert made.documentation == "Lets a rope out and hauls it in. The rope is dry."
    inputs = {message.name: message.documentation for message in made.inputs}
    assert inputs == {
        "SetRope": "Pays rope out.",
        "QueryRope": "Asks for the rope.",
        "StopWinch": "Stops at once.",
    }
    rope = made.inputs[0].body.fields
    assert [field.documentation for field in rope] == [
        "Rope that is paid out.",
        "Rope left on the drum.",
        "Whole turns are lost.",
    ]


def test_xml_1_1_and_processing_instructions_are_read():
    text = service().replace('version="1.0" encoding', 'version="1.1" encoding', 1)
    text = text.replace("?>", '?><?editor schema="none"?>', 1)
    assert good(text).name == "Lamp"


@for_each(
    ("urn", "name"),
    [
        ("urn:acme:jaus:Sampler", "acme"),
        ("urn:jaus:jss:mobility:Sampler", "mobility"),
        ("urn:acme:rovers:Sampler", "rovers"),
        ("urn:jaus:Sampler", "sampler"),
    ],
)
def test_a_set_is_named_after_what_tells_it_from_others(urn, name):
    text = service().replace('id="urn:example:light:Lamp"', f'id="{urn}"')
    assert urn in text
    assert [service_set.name for service_set in run(text).sets] == [name]
