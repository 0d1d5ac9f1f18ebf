"""What is shown of a message is taken back; errors name all fields that are wrong."""

from time import process_time

import pytest

from jausml.live.messages import EncodeError
from jausml.live.messages.field_paths import by_name, parse_fields
from jausml.live.messages.text import paths_of
from jausml.live.peers.rendering import shown_fields

ELEMENT = {"ElementUID": 1, "PreviousUID": 0, "NextUID": 0}


def test_a_path_may_begin_where_one_place_has_its_name(catalogue):
    lamps = catalogue.named("SetIlluminationState")[0]
    bits = {"Headlights": 1, "FogLights": "OFF"}
    whole = {"illuminationRec": {"illumination": bits}}
    assert lamps.completed(bits) == whole
    assert lamps.completed({"illumination": bits}) == whole
    assert lamps.completed(whole) == whole
    with pytest.raises(EncodeError, match="HighBeams: this field is absent") as found:
        lamps.encode(lamps.completed(bits))
    assert "unknown" not in str(found.value)


@pytest.mark.parametrize(
    ("name", "fields"),
    [
        ("SetWrenchEffort", {"PropulsiveLinearEffortX": 20.0, "PropulsiveLinearEffortY": -3.5}),
        ("ReportStatus", {"Status": "READY", "Reserved": 0}),
        ("SetJointPositions", {"JointPositionList": [{"JointPosition": {"radian": 0.1}}]}),
        (
            "SetElement",
            {
                "RequestIDRec": {"RequestID": 3},
                "ElementList": [
                    {**ELEMENT, "ElementData": {"SetGlobalWaypoint": {"Latitude": 46.5}}}
                ],
            },
        ),
        ("ReportElementList", {"ElementList": [{"ElementUID": 3}, {"ElementUID": 9}]}),
        ("QueryEvents", {"EventIDRec": {"EventID": 7}}),
        ("ReportIdentification", {"QueryType": 2, "Type": 10001, "Identification": "a b"}),
        ("ReportElementList", {"ElementList": []}),
    ],
)
def test_a_line_that_is_shown_is_taken(catalogue, name, fields):
    entry = catalogue.named(name)[0]
    if name == "SetElement":
        fields["ElementList"][0]["ElementData"]["SetGlobalWaypoint"]["Longitude"] = 8.25
    payload = entry.encode(entry.completed(fields))
    shown = shown_fields(entry, entry.decode(payload))
    again = entry.encode(entry.completed(parse_fields(shown)))
    assert shown_fields(entry, entry.decode(again)) == shown


def test_a_variable_field_is_chosen_by_its_unit(catalogue):
    entry = catalogue.named("SetJointPositions")[0]

    def encoded(position):
        return entry.encode(entry.completed({"JointPositionList": [{"JointPosition": position}]}))

    assert (
        encoded({"radian": 0.1})
        == encoded("0.1 rad")
        == encoded({"index": 1, "value": 0.1})
        != encoded({"meter": 0.1})
    )
    with pytest.raises(EncodeError, match=r"JointPosition: '0.1 foot' is not an object"):
        encoded("0.1 foot")


@pytest.mark.parametrize("value", ["20", "20 m", "20 percents", "1e5 %"])
def test_another_unit_is_no_number(catalogue, value):
    entry = catalogue.message("SetWrenchEffort")
    with pytest.raises(EncodeError, match="PropulsiveLinearEffortX: "):
        entry.encode(entry.completed({"PropulsiveLinearEffortX": value}))


@pytest.mark.parametrize("value", ["1" * 100_000, "1" * 5000 + " (READY)", "1 (STANDBY)"])
def test_a_text_that_is_no_shown_value_is_refused_at_once(catalogue, value):
    begin = process_time()
    with pytest.raises(EncodeError, match="Status: '1"):
        catalogue.encode({"message": "ReportStatus", "fields": {"Status": value, "Reserved": 0}})
    with pytest.raises(EncodeError, match="LinearEffortX: '1"):
        catalogue.encode(
            {"message": "SetWrenchEffort", "fields": {"PropulsiveLinearEffortX": value}}
        )
    assert process_time() - begin < 1


def test_a_version_that_contradicts_that_of_the_service_is_refused(catalogue):
    message = {"message": "QueryStatus", "service": "Management/1.0", "service_version": "1.1"}
    with pytest.raises(
        EncodeError, match=r"service_version: '1\.1' is not that of Management/1\.0"
    ):
        catalogue.encode(message)
    assert catalogue.encode({**message, "service_version": "1.0"}) == bytes.fromhex("0220")


@pytest.mark.parametrize("other", [{"ReportStatus": {"Status": 1, "Reserved": 0}}, {"x": 1}])
@pytest.mark.parametrize("whole", [{"message": {"message": "QueryStatus"}}, {"hex": "0220"}])
def test_what_stands_beside_a_message_is_not_lost(catalogue, whole, other):
    event = {"EventID": 1, "SequenceNumber": 2, "ReportMessage": {**whole, **other}}
    with pytest.raises(EncodeError, match=rf"ReportMessage\.{next(iter(other))}: unknown field"):
        catalogue.encode({"message": "Event", "fields": event})


def test_all_wrong_fields_are_named(catalogue):
    entry = catalogue.message("SetWrenchEffort")
    fields = {
        "Thrust": 1,
        "PropulsiveLinearEffortX": 500,
        "Lift": 2,
        "PropulsiveLinearEffortY": "x",
        "PropulsiveLinearEffortZ": 1,
    }
    with pytest.raises(EncodeError) as caught:
        entry.encode(entry.completed(fields))
    assert [word.partition(":")[0] for word in str(caught.value).split("; WrenchEffortRec.")] == [
        "WrenchEffortRec.Thrust",
        "Lift",
        "PropulsiveLinearEffortX",
        "PropulsiveLinearEffortY",
    ]


def test_what_is_wrong_in_several_records_is_named(kinds):
    body = {"First": {"X": "a"}, "Numbers": {"Signed": 1.5}, "Lists": 3, "Choice": {}}
    with pytest.raises(EncodeError) as caught:
        kinds.message("Kinds").encode({"Body": body})
    text = str(caught.value)
    for path in ("First.X", "Numbers.Wide", "Numbers.Signed", "Lists", "Choice._tag"):
        assert text.count(f"Body.{path}: ") == 1


@pytest.mark.parametrize(
    ("fields", "error"),
    [
        ({"A[1]": 1}, r"A\[1\]: element 0 is not given before"),
        ({"A.B": 1, "A[0]": 1}, r"A\[0\]: this contradicts another field"),
        ({"A": 1, "A.B": 1}, r"A\.B: this contradicts another field"),
        ({"A.B": 1, "A": 1}, "A: this contradicts another field"),
        ({"A[0]": 1, "A": [2]}, "A: this contradicts another field"),
        ({"A.B": 1, "A": {"B": 2}}, "A: this contradicts another field"),
        ({".".join("A" * 9999): 1}, "nested too deep"),
    ],
)
def test_paths_that_lead_nowhere(fields, error):
    with pytest.raises(EncodeError, match=error):
        by_name(fields)


def test_objects_and_paths_are_joined_in_any_order_and_remain_as_they_were():
    inner = {"X": 1, "Y": {"Z": 2}}
    whole = {"A": {"X": 1, "Y": {"Z": 2, "W": 3}}}
    assert by_name({"A": inner, "A.Y.W": 3}) == by_name({"A.Y.W": 3, "A": inner}) == whole
    assert by_name({"L": [inner], "L[0].W": 3}) == {"L": [{**inner, "W": 3}]}
    assert inner == {"X": 1, "Y": {"Z": 2}}


def test_a_field_by_its_whole_path_and_by_the_end_of_it_is_refused(catalogue):
    lamps = catalogue.named("SetIlluminationState")[0]
    with pytest.raises(EncodeError, match=r"illumination\.Headlights: this is there twice"):
        lamps.completed({"Headlights": 1, "illumination.Headlights": 0})


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ('{"A": "B=1"}', {"A": "B=1"}),
        ("A=1 B.C[0]=x y  D='q'", {"A": 1, "B.C[0]": "x y", "D": "q"}),
        ('A={"x": [1]}', {"A": {"x": [1]}}),
    ],
)
def test_fields_in_words(text, fields):
    assert parse_fields(text) == fields


@pytest.mark.parametrize("text", ["A", "x A=1", "[1]", ""])
def test_what_are_no_fields(text):
    with pytest.raises(ValueError, match="fields"):
        parse_fields(text)


def test_a_field_is_assigned_once():
    with pytest.raises(ValueError, match=r"A\.B: this is there twice"):
        parse_fields("A.B=1 C=2 A.B=1")


def test_paths_of_a_message(catalogue):
    assert paths_of(catalogue.named("SetJointPositions")[0]) == [
        "JointPositionList[0].JointPosition"
    ]
    assert "illumination.Headlights" in paths_of(catalogue.message("SetIlluminationState"))
    assert paths_of(catalogue.message("QueryStatus")) == []
