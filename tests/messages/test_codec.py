"""Fields and their wire form: shapes, limits, and errors that name the field."""

import copy
import json
import math
import tracemalloc
from fractions import Fraction

import jsonschema
import numpy
import pytest

from jausml.language import wire
from jausml.live.messages import DecodeError, EncodeError
from jausml.live.messages.codec import codec_of
from jausml.live.messages.values import legal_integer
from jausml.live.recording.schemas import schema_of

NUMBERS = {
    "Signed": -2,
    "Wide": 1.0,
    "Down": 7.9,
    "Up": 7.1,
    "Real": -0.5,
    "Gap": 7,
    "Matrix": [1, 2, 3, 4],
    "Labels": ["a", "\xe9"],
}
BODY = {
    "First": {"X": 1.5},
    "Numbers": NUMBERS,
    "Lists": [[1, 2], []],
    "Choice": {"_tag": 0, "A": {"V": {"index": 1, "value": -1}}},
}


def encode(kinds, **changes):
    fields = {name: value for name, value in {**BODY, **changes}.items() if value is not None}
    return kinds.message("Kinds").encode({"Body": fields})


def test_every_kind_of_field(kinds):
    payload = encode(kinds)
    assert payload == bytes.fromhex(
        "0001 00 0000c03f feff ffffffffffffffff 07 08 000000000000e0bf 07 01020304 0161 01e9"
        "0200 020102 00 00 01 ff"
    )
    decoded = kinds.message("Kinds").decode(payload)
    assert decoded["Body"] == {"_pv": 0, **BODY, "Numbers": {**NUMBERS, "Down": 7.0, "Up": 8.0}}
    entry = kinds.message("Kinds")
    jsonschema.validate({"fields": entry.shortened(decoded)}, schema_of(entry))
    with_second = encode(kinds, Second={"X": 2})
    assert with_second[2] == 1
    assert kinds.message("Kinds").decode(with_second)["Body"]["Second"] == {"X": 2.0}


def test_a_tag_may_be_left_out_when_the_option_tells_it(kinds):
    assert encode(kinds, Choice={"B": []}) == encode(kinds, Choice={"_tag": 1, "B": []})


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"First": None}, "Body.First: this field is absent"),
        ({"Frist": {}}, "Body.Frist: unknown field; did you mean First?"),
        ({"First": 1}, "Body.First: 1 is not an object of fields"),
        ({"First": {"X": "1"}}, "Body.First.X: '1' is not a number"),
        ({"First": {"X": True}}, "Body.First.X: true is not a number"),
        ({"First": {"X": None}}, "Body.First.X: null is not a number"),
        ({"First": {"X": math.nan}}, "Body.First.X: nan is outside"),
        ({"First": {"X": math.inf}}, "Body.First.X: inf is outside"),
        ({"First": {"X": 10**400}}, "Body.First.X: an integer of 1329 bits is outside"),
        ({"_pv": 1}, "Body._pv: 1 given, but the members that are there make 0"),
        ({"_pv": True}, "Body._pv: true given"),
        ({"Numbers": {**NUMBERS, "Signed": 32768}}, "Body.Numbers.Signed: 32768 is not among"),
        ({"Numbers": {**NUMBERS, "Signed": 1.5}}, "Body.Numbers.Signed: 1.5 is not an integer"),
        (
            {"Numbers": {**NUMBERS, "Gap": 8}},
            "Body.Numbers.Gap: 8 is not among the legal values 0 (off), 4 .. 7",
        ),
        ({"Numbers": {**NUMBERS, "Wide": 1.1}}, "Body.Numbers.Wide: 1.1 is outside 0.0 .. 1.0"),
        ({"Numbers": {**NUMBERS, "Wide": 10**400}}, "Body.Numbers.Wide: an integer of 1329 bits"),
        ({"Numbers": {**NUMBERS, "Wide": math.nan}}, "Body.Numbers.Wide: nan is outside"),
        ({"Numbers": {**NUMBERS, "Matrix": [1]}}, "Body.Numbers.Matrix: 1 elements instead of 4"),
        ({"Numbers": {**NUMBERS, "Matrix": [1, 2, 3, 256]}}, "Body.Numbers.Matrix[3]: 256 is not"),
        ({"Numbers": {**NUMBERS, "Labels": ["a", "€"]}}, "Body.Numbers.Labels[1]: '€' has char"),
        ({"Lists": [[], [], [], []]}, "Body.Lists: count 4 is outside 0 .. 3"),
        ({"Lists": [[1, -1]]}, "Body.Lists[0][1]: -1 is not among"),
        ({"Lists": {}}, "Body.Lists: an object of 0 is not a list"),
        ({"Choice": {}}, "Body.Choice._tag: this field is absent, the options are 0 A, 1 B"),
        ({"Choice": {"_tag": 3}}, "Body.Choice._tag: 3 is not among the legal values 0 .. 2"),
        ({"Choice": {"_tag": 0, "B": []}}, "Body.Choice.B: unknown field"),
        (
            {"Choice": {"_tag": 0, "A": {"V": {"index": 2, "value": 0}}}},
            "A.V.index: 2 names no type",
        ),
        ({"Choice": {"_tag": 0, "A": {"V": {"index": 1, "value": 128}}}}, "A.V.value: 128 is not"),
    ],
)
def test_what_cannot_be_encoded_is_refused_at_its_place(kinds, changes, error):
    with pytest.raises(EncodeError) as caught:
        encode(kinds, **changes)
    assert error in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"Gap": "q"}, "Numbers.Gap: 'q' is no name of a legal value; they are 0 (off), 4 .. 7"),
        ({"Gap": "Off"}, "Numbers.Gap: 'Off' is no name of a legal value; did you mean 'off'?"),
        ({"Signed": "off"}, "Numbers.Signed: 'off' is not a number"),
        ({"Gaps": 0}, "Numbers.Gaps: unknown field; did you mean Gap?"),
        ({"Qqqqq": 0}, "Numbers.Qqqqq: unknown field"),
    ],
)
def test_a_name_that_is_none_is_refused_with_those_there_are(kinds, changes, error):
    with pytest.raises(EncodeError) as caught:
        encode(kinds, Numbers={**NUMBERS, **changes})
    assert error in str(caught.value)


def test_the_name_of_a_value_stands_for_it(kinds, catalogue):
    assert encode(kinds, Numbers={**NUMBERS, "Gap": "off"}) == encode(
        kinds, Numbers={**NUMBERS, "Gap": 0}
    )
    status = catalogue.message("ReportStatus", "Management/1.1")
    named = {"ReportStatusRec": {"Status": "EMERGENCY", "Reserved": 0}}
    assert status.decode(status.encode(named))["ReportStatusRec"]["Status"] == 5


@pytest.mark.parametrize(
    ("message", "fields", "error"),
    [
        (
            "SetVelocityCommand",
            {"VelocityCommandRec": {}},
            "CommandType: this field is absent, it takes 0 (Set current command), 1 (Set maximum",
        ),
        (
            "SetVelocityCommand",
            {"VelocityCommandRec": {"CommandType": "Set curent command"}},
            "CommandType: 'Set curent command' is no name of a legal value; "
            "did you mean 'Set current command'?",
        ),
        ("SetTravelSpeed", {"TravelSpeedRec": {}}, "absent, it takes 0.0 .. 327.67 meter per"),
        ("CreateEvent", {}, "CreateEventRec.RequestID: this field is absent, it takes 0 .. 255"),
    ],
)
def test_an_absent_field_tells_what_it_takes(catalogue, message, fields, error):
    with pytest.raises(EncodeError) as caught:
        catalogue.encode({"message": message, "fields": fields})
    assert error in str(caught.value)


def test_a_real_without_a_fraction_is_an_integer(kinds):
    """JSON does not tell 1.0 from 1."""
    assert encode(kinds, Numbers={**NUMBERS, "Signed": -2.0}) == encode(kinds)


@pytest.mark.parametrize(
    ("payload", "error"),
    [
        ("0244", "GlobalPoseRec._pv: 2 bytes wanted at offset 2, 0 left"),
        ("02440300000000", "GlobalPoseRec.Latitude: 4 bytes wanted at offset 4, 3 left"),
        ("0244030000000000ffff", "GlobalPoseRec.Longitude: 4 bytes wanted at offset 8, 2 left"),
        ("02440008", "GlobalPoseRec._pv: bits 0x800 stand for no member"),
        ("024400800000", "GlobalPoseRec._pv: bits 0x8000 stand"),
        ("0240010000000000", "1 bytes follow the body of ReportStatus"),
        ("f02104", "QueryEventsVar._tag: 4 names no option, the options are 0 MessageIDRec"),
        ("f021", "QueryEventsVar._tag: 1 byte wanted"),
        ("034b01ff02", "NodeList[0].ComponentList: count 2 needs more than the 0 bytes"),
        ("000b02000000", "ServiceList: count 2 needs more than the 3 bytes that follow"),
        ("034bff0102", "NodeList: count 255 needs more than the 2 bytes that follow"),
        ("0206010300000000", "JointPositionList[0].JointPosition.index: 3 names no type"),
        ("f041", "EventList: 1 byte wanted"),
        ("f1410102ffffffff", "EventRec.ReportMessage: length 4294967295 is more than the 0 bytes"),
        ("1a4400000000000000", "ElementRec.ElementData.hex: 2 bytes wanted at offset 9"),
        ("1a44000000000000", "ElementRec.ElementData.format: 1 byte wanted at offset 8"),
    ],
)
def test_what_cannot_be_decoded_says_where(catalogue, payload, error):
    with pytest.raises(DecodeError) as caught:
        catalogue.decode(bytes.fromhex(payload))
    assert str(caught.value).startswith(error)


def test_a_huge_count_takes_no_memory(catalogue):
    entry = catalogue.message("ReportServiceList")
    tracemalloc.start()
    try:
        with pytest.raises(DecodeError, match="SubsystemList: count 65535 needs more"):
            entry.decode(b"\x04\x4b\xff\xff" + b"\0" * 60)
        assert tracemalloc.get_traced_memory()[1] < 1 << 16
    finally:
        tracemalloc.stop()


def test_a_presence_vector_without_room_for_a_member(catalogue):
    """CBRNDetection has 14 optional members and a vector of 8 bits."""
    entry = catalogue.message("CBRNDetection")
    (record,) = entry.record.members
    last = record.kind.members[-1]
    assert last.bit > 0xFF
    least = {member.name: 0 for member in record.kind.members if not member.bit}
    error = f"_pv: no bit stands for {last.name}, the vector has 8: leave it out"
    with pytest.raises(EncodeError, match=error):
        entry.encode({record.name: {**least, last.name: 0}})
    with_bits = {
        member.name: "" if isinstance(member.kind, wire.Text) else 0
        for member in record.kind.members
        if 0 < member.bit <= 0xFF
    }
    decoded = entry.decode(entry.encode({record.name: {**least, **with_bits}}))[record.name]
    assert decoded["_pv"] == 0xFF
    assert last.name not in decoded


def test_embedded_messages_stand_in_the_place_of_their_hex(catalogue):
    event = bytes.fromhex("f1410102070000000240 0100000000")
    decoded = catalogue.decode(event)
    embedded = decoded.fields["EventRec"]["ReportMessage"]["message"]
    assert embedded.decoded.entry.name == "ReportStatus"
    printed = json.loads(json.dumps(decoded.to_json()))
    holder = printed["fields"]["EventRec"]["ReportMessage"]
    assert list(holder) == ["message"]
    assert holder["message"]["fields"] == {"ReportStatusRec": {"Status": "READY", "Reserved": 0}}
    assert catalogue.encode(printed) == event
    holder["message"]["fields"]["ReportStatusRec"]["Status"] = 2
    assert catalogue.encode(printed) == event[:10] + b"\x02" + event[11:]
    holder["message"]["message"] = "ReportStatu"
    with pytest.raises(EncodeError, match=r"EventRec.ReportMessage.message: .*did you mean"):
        catalogue.encode(printed)


def test_embedded_messages_of_lists(catalogue):
    payload = bytes.fromhex("1a045c02 0100 0000 0200 00 0200 0220 0200 0100 0000 01 0200 0220")
    decoded = catalogue.decode(payload)
    assert catalogue.encode(decoded.to_json()) == payload
    elements = decoded.to_json()["fields"]["SetElementSeq"]["ElementList"]
    assert elements[0]["ElementData"]["message"]["message"] == "QueryStatus"
    assert elements[1]["ElementData"] == {"format": 1, "hex": "0220"}  # of the user's own format
    del elements[0]["ElementData"]["format"]  # which a message tells
    assert (
        catalogue.encode(
            {
                "message": "SetElement",
                "fields": {
                    "SetElementSeq": {"RequestIDRec": {"RequestID": 0x5C}, "ElementList": elements}
                },
            }
        )
        == payload
    )


def test_an_embedded_message_that_cannot_be_decoded_harms_nothing(catalogue):
    payload = bytes.fromhex("f141010202000000ffff")
    decoded = catalogue.decode(payload)
    holder = decoded.to_json()["fields"]["EventRec"]["ReportMessage"]
    assert holder == {"hex": "ffff", "message": {"error": "no message has the code 0xFFFF"}}
    assert catalogue.encode(decoded.to_json()) == payload


def test_messages_nested_without_end_are_decoded_to_a_depth(catalogue):
    payload = b"\xff\xff"
    for _ in range(2000):
        payload = b"\xf1\x41\0\0" + len(payload).to_bytes(4, "little") + payload
    decoded = catalogue.decode(payload)
    depth = 0
    fields = decoded.fields
    while embedded := fields["EventRec"]["ReportMessage"].get("message"):
        depth += 1
        fields = embedded["fields"]
    assert depth == 8
    assert catalogue.encode(decoded.to_json()) == payload


def test_integers_have_their_names(catalogue):
    fields = catalogue.decode(bytes.fromhex("02400100000000")).fields["ReportStatusRec"]
    status, reserved = fields["Status"], fields["Reserved"]
    assert status == "READY"
    assert status == 1
    assert status not in ("STANDBY", 2)
    assert int(status) == 1
    assert f"{status}" == "READY"
    assert json.dumps(fields) == '{"Status": "READY", "Reserved": 0}'
    assert int(copy.deepcopy(status)) == 1
    assert type(reserved) is int
    status_message = catalogue.message("ReportStatus")
    for given in (status, "READY", 1):
        record = {"Status": given, "Reserved": 0}
        assert status_message.encode({"ReportStatusRec": record}).hex() == "02400100000000"
    # What no name stands for, or several numbers have in common, stays a number.
    unknown = catalogue.decode(bytes.fromhex("02400900000000")).fields["ReportStatusRec"]["Status"]
    assert type(unknown) is int


def test_bits_have_their_names(catalogue):
    lights = catalogue.message("SetIlluminationState")
    groups = lights.record.members[0].kind.members[0].kind.groups
    bits = {group.name: "OFF" if group.legal.names else 0 for group in groups}
    payload = lights.encode(lights.completed({"illumination": {**bits, "Headlights": 1}}))
    fields = lights.shortened(lights.decode(payload))["illumination"]
    assert fields["Headlights"] == "ON"
    assert fields["FogLights"] == "OFF"
    assert [bool(fields[field_name]) for field_name in ("Headlights", "FogLights")] == [True, False]
    assert lights.encode(lights.completed({"illumination": fields})) == payload


@pytest.mark.parametrize("value", ["0", "zz", 7, None])
def test_octets_that_are_no_hex(catalogue, value):
    message = {
        "message": "Event",
        "fields": {
            "EventRec": {"EventID": 0, "SequenceNumber": 0, "ReportMessage": {"hex": value}}
        },
    }
    with pytest.raises(EncodeError, match=r"EventRec\.ReportMessage\.hex: .* is not"):
        catalogue.encode(message)


@pytest.mark.parametrize("number", [Fraction(25, 2), "float32"])
def test_numbers_of_other_packages_are_numbers(catalogue, number):
    """Values of a notebook are mostly those of numpy."""
    if isinstance(number, str):
        number = getattr(numpy, number)(12.5)
    fields = {"PropulsiveLinearEffortX": number}
    plain = {"PropulsiveLinearEffortX": 12.5}
    encode = catalogue.message("SetWrenchEffort").encode
    assert encode({"WrenchEffortRec": fields}) == encode({"WrenchEffortRec": plain})


def test_an_integer_with_its_unit_keeps_all_of_its_digits():
    count = 2**53 + 1
    assert legal_integer(f"{count} s", ((0, 2**64 - 1),), unit="second") == count


def test_integers_of_other_packages_are_integers(catalogue):
    entry = catalogue.message("SetVelocityCommand")
    assert entry.encode({"VelocityCommandRec": {"CommandType": numpy.uint8(1)}}) == entry.encode(
        {"VelocityCommandRec": {"CommandType": 1}}
    )


def test_members_with_dots_and_brackets_in_their_names_are_blamed_once():
    bit = wire.Integer(wire.UNSIGNED["uint8"], wire.LegalIntegers(((0, 1),)))
    names = ("A.B", "C[0]", "D")
    record = wire.Record(tuple(wire.Field(name, "", bit) for name in names))
    with pytest.raises(EncodeError) as error:
        codec_of(record, None).write(dict.fromkeys(names, 9), bytearray())
    assert [part.partition(": ")[0] for part in str(error.value).split("; ")] == list(names)
