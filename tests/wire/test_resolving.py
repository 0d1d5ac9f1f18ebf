"""Tests of the wire model: every kind of field of the metamodel has a layout, free of the model."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import get_args

import pytest

from jausml.language import wire
from jausml.language.metamodel import load_metamodels
from jausml.language.metamodel.classes import jaus
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model import library_root, read_models

EVERY_KIND = Path(__file__).parents[1] / "generators" / "every_kind.xmi"
HEAD = (
    '<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
    ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
    ' xmlns:jaus="http://www.jausml.org/jaus/1.0" name="set">'
)


def messages_of(path: Path) -> dict[str, jaus.MessageDef]:
    model = read_models([path]).model
    return {message_def.name: message_def for message_def in model.instances(jaus.MessageDef)}


def resolved(tmp_path: Path, body: str, declared: str = "") -> wire.Message:
    path = tmp_path / "model.xmi"
    path.write_text(
        f'{HEAD}{declared}<services name="S" urn="urn:s"><inputs name="M" code="0x0100">'
        f"{body}</inputs></services></jaus:ServiceSet>",
        encoding="utf-8",
    )
    return wire.resolve(messages_of(path)["M"])


def parts(layout: object) -> Iterator[object]:
    yield layout
    if isinstance(layout, tuple):
        for part in layout:
            yield from parts(part)
    elif is_dataclass(layout):
        for field in fields(layout):
            yield from parts(getattr(layout, field.name))


def test_every_kind_is_reached_from_every_class_of_fields():
    found = messages_of(EVERY_KIND)
    layouts = tuple(wire.resolve(message) for message in found.values())
    kinds = {type(part.kind) for part in parts(layouts) if isinstance(part, wire.Field)}
    kinds |= {type(part.number) for part in parts(layouts) if isinstance(part, wire.Alternative)}
    assert kinds == set(get_args(wire.Kind))
    used = {type(field).__name__ for field in read_models([EVERY_KIND]).model.instances(jaus.Field)}
    subtypes = load_metamodels().class_of(jaus.Field).subtypes
    assert used == {subtype.name for subtype in subtypes if not subtype.abstract}


def test_nothing_of_the_model_is_left_in_a_layout():
    for path in (EVERY_KIND, *sorted((library_root() / "jaus").glob("*.xmi"))):
        for message in messages_of(path).values():
            layout = wire.resolve(message)
            assert not [part for part in parts(layout) if isinstance(part, EObject)]
            assert hash(layout) == hash(wire.resolve(message))


def test_the_layout_of_a_message():
    report = messages_of(library_root() / "jaus" / "core-1.1.xmi")["ReportStatus"]
    layout = wire.resolve(report)
    assert (layout.code, layout.header.name, layout.is_command) == (0x4002, "uint16", False)
    assert layout.service == "urn:jaus:jss:core:Management"
    assert [member.name for member in layout.members] == ["Status", "Reserved"]
    status = layout.members[0].kind
    assert isinstance(status, wire.Integer)
    assert status.legal.names[1] == "READY"
    assert status.legal.is_closed


def test_a_reference_lends_its_name_and_its_optionality(tmp_path):
    layout = resolved(
        tmp_path,
        '<body xsi:type="jaus:Record" name="B" presenceVector="uint8">'
        '<fields xsi:type="jaus:TypeReference" name="Own" optional="true" target="X"/>'
        '<fields xsi:type="jaus:FixedField" name="Always"/>'
        '<fields xsi:type="jaus:TypeReference" name="Two" optional="true" target="X"/></body>',
        '<types xsi:type="jaus:FixedField" xmi:id="X" name="X" documentation="An X."/>',
    )
    own, always, two = layout.members
    assert (own.name, own.documentation, own.bit, own.is_optional) == ("Own", "An X.", 1, True)
    assert (always.bit, two.bit) == (0, 2)
    assert own.kind is two.kind
    assert isinstance(layout.body.kind, wire.Record)  # type: ignore[union-attr]


def test_without_a_presence_vector_all_members_are_there(tmp_path):
    layout = resolved(
        tmp_path,
        '<body xsi:type="jaus:Record" name="B">'
        '<fields xsi:type="jaus:FixedField" name="F" optional="true"/></body>',
    )
    assert not layout.members[0].is_optional


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        (
            '<body xsi:type="jaus:Record" xmi:id="R" name="R">'
            '<fields xsi:type="jaus:TypeReference" name="Again" target="R"/></body>',
            "M.R.Again: it contains itself",
        ),
        (
            '<body xsi:type="jaus:TypeReference" xmi:id="T" name="T" target="T"/>',
            "M.T: the type reference leads to no type",
        ),
        (
            '<body xsi:type="jaus:Record" name="R"><fields xsi:type="jaus:FixedField" name="F"'
            ' type="int8"><scale lower="0" upper="1"/></fields></body>',
            "M.R.F: 0.0 .. 1.0 is no scale of int8",
        ),
        (
            '<body xsi:type="jaus:Variant" name="V" tagType="float32"/>',
            "M.V: float32 is no unsigned integer",
        ),
        (
            '<body xsi:type="jaus:VariableField" name="V"><alternatives name="a" index="256"/>'
            "</body>",
            "M.V: the indices of its alternatives do not lie in 0 .. 255",
        ),
    ],
)
def test_what_has_no_layout_says_where(tmp_path, body, reason):
    with pytest.raises(wire.LayoutError) as caught:
        resolved(tmp_path, body)
    assert str(caught.value) == reason


@pytest.mark.parametrize(
    ("values", "ranges"),
    [
        ("", ((0, 255),)),
        ('<values xsi:type="jaus:ValueRange" lower="300" upper="400"/>', ((0, 255),)),
        ('<values xsi:type="jaus:ValueRange" lower="NaN" upper="4"/>', ((0, 255),)),
        ('<values xsi:type="jaus:ValueRange" lower="-INF" upper="4.5"/>', ((0, 4),)),
        (
            '<values xsi:type="jaus:ValueRange" lower="1" upper="4" lowerInclusive="false"/>'
            '<values xsi:type="jaus:EnumeratedValue" name="five" value="5"/>'
            '<values xsi:type="jaus:EnumeratedValue" name="nine" value="9"/>',
            ((2, 5), (9, 9)),
        ),
        (
            '<values xsi:type="jaus:ValueRange" lower="0.5" upper="2.5" lowerInclusive="false"'
            ' upperInclusive="false"/>',
            ((1, 2),),
        ),
    ],
)
def test_legal_integers(tmp_path, values, ranges):
    wanted = f"<values>{values}</values>" if values else ""
    layout = resolved(tmp_path, f'<body xsi:type="jaus:FixedField" name="F">{wanted}</body>')
    kind = layout.members[0].kind
    assert isinstance(kind, wire.Integer)
    assert kind.legal.ranges == ranges


@pytest.mark.parametrize(
    ("limits", "legal"),
    [
        ('lower="0.1" upper="1" upperInclusive="false"', (0.1, 1.0 - 2.0**-24)),
        ('lower="-1" lowerInclusive="false" upper="-0.1"', (-1.0 + 2.0**-24, -0.1)),
        (
            'lower="-2" upper="-1" lowerInclusive="false" upperInclusive="false"',
            (-2.0 + 2.0**-23, -1.0 - 2.0**-23),
        ),
    ],
)
def test_limits_of_single_reals_are_singles(tmp_path, limits, legal):
    layout = resolved(
        tmp_path,
        '<body xsi:type="jaus:FixedField" name="F" type="float32"><values>'
        f'<values xsi:type="jaus:ValueRange" {limits}/>'
        "</values></body>",
    )
    kind = layout.members[0].kind
    assert isinstance(kind, wire.Real)
    assert (kind.legal.lower, kind.legal.upper) == legal


def test_layouts_compare_by_what_matters(tmp_path):
    field = '<body xsi:type="jaus:FixedField" name="{}" units="{}"/>'
    one = resolved(tmp_path, field.format("F", "meter"))
    other = resolved(tmp_path, field.format("F", "second"))
    named = resolved(tmp_path, field.format("G", "meter"))
    assert one != other
    assert wire.comparable(one, {"units"}) == wire.comparable(other, {"units"})
    assert wire.comparable(one, {"units"}) != wire.comparable(named, {"units"})
    assert wire.comparable(one, {"name"}) == wire.comparable(named, {"name"})
