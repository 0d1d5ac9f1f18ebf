"""Fields in words, plain queries, and what a name of a message means."""

import pytest

from jausml.live.messages import MessageError
from jausml.live.peers.entry_messages import find_exchange, full_query, message_class, plain_query
from jausml.live.peers.rendering import shown_fields
from jausml.runtime import Scope, ServiceIdentity
from jausml.runtime.wire.message import DecodeError, EncodeError


@pytest.mark.parametrize(
    ("name", "fields", "text"),
    [
        (
            "ReportVelocityState",
            {"ReportVelocityStateRec": {"Velocity_X": -1.5, "YawRate": 0.0}},
            "Velocity_X=-1.5000000 m/s  YawRate=0 rad/s",
        ),
        (
            "ReportTime",
            {
                "TimeRec": {
                    "TimeStamp": {
                        "Milliseconds": 7,
                        "Seconds": 5,
                        "Minutes": 4,
                        "Hour": 3,
                        "Day": 21,
                    }
                }
            },
            "TimeStamp=day 21 03:04:05.007",
        ),
        ("QueryControl", {}, "(no fields)"),
        ("ReportElementList", {"ElementList": []}, "ElementList=[]"),
        (
            "ReportElementList",
            {"ElementList": [{"ElementUID": 3}, {"ElementUID": 9}]},
            "ElementList[0].ElementUID=3  ElementList[1].ElementUID=9",
        ),
        (
            "QueryEvents",
            {"QueryEventsVar": {"_tag": 2, "EventIDRec": {"EventID": 7}}},
            "QueryEventsVar.EventIDRec.EventID=7",
        ),
    ],
)
def test_fields_with_units_and_names(name, fields, text, catalogue):
    entry = catalogue.message(name)
    assert shown_fields(entry, entry.decode(entry.encode(fields))) == text


def test_listed_values_are_named(catalogue):
    entry = catalogue.message("ReportStatus")
    fields = {"ReportStatusRec": {"Status": 2, "Reserved": 0}}
    assert shown_fields(entry, fields) == "Status=2 (STANDBY)  Reserved=0"


def test_every_query_of_the_library_has_plain_fields_that_encode(catalogue):
    queries = [entry for entry in catalogue.messages if entry.name.startswith("Query")]
    assert len(queries) > 100
    for query in queries:
        assert query.decode(query.encode(plain_query(query))) is not None


@pytest.mark.parametrize(
    ("name", "scope"),
    [
        ("QueryIdentification", Scope.COMPONENT),  # 4 in AS5710; whoever answers tells of itself
        ("QueryConfiguration", Scope.NODE),  # 3: a component knows its node, not its subsystem
    ],
)
def test_a_plain_query_of_discovery_asks_for_what_one_component_knows(name, scope, catalogue):
    ((record, fields),) = plain_query(catalogue.message(name)).items()
    assert (record, fields) == (f"{name}Rec", {"QueryType": scope})


def test_a_full_query_asks_for_each_optional_field(catalogue):
    query, report = find_exchange(catalogue, "VelocityState")
    assert full_query(query, report) == {"QueryVelocityStateRec": {"PresenceVector": 0x1FF}}


@pytest.mark.parametrize("name", ["Status", "QueryStatus", "ReportStatus", "2002", "0x2002"])
def test_an_exchange_by_any_of_its_names(name, catalogue):
    query, report = find_exchange(catalogue, name)
    assert (query.name, report.name) == ("QueryStatus", "ReportStatus")


def test_services_decide_between_messages_of_one_name(catalogue):
    with pytest.raises(MessageError, match="several meanings"):
        find_exchange(catalogue, "ActiveElement")
    service = ServiceIdentity("urn:jaus:jss:mobility:LocalWaypointListDriver", 1, 0)
    query, report = find_exchange(catalogue, "ActiveElement", [service])
    assert (query.code, report.code) == (0x241E, 0x441E)


def test_what_is_no_exchange(catalogue):
    with pytest.raises(MessageError, match="did you mean"):
        find_exchange(catalogue, "VelocityStat")
    with pytest.raises(MessageError, match="SetWrenchEffort is no query"):
        find_exchange(catalogue, "SetWrenchEffort")


def test_a_message_of_the_catalogue_serves_the_runtime(catalogue):
    entry = catalogue.message("ReportStatus")
    report = message_class(entry)
    assert report is message_class(entry)
    payload = report({"ReportStatusRec": {"Status": 1, "Reserved": 0}}).encode()
    assert payload.hex() == "02400100000000"
    assert report.decode(payload).fields["ReportStatusRec"]["Status"] == 1
    with pytest.raises(DecodeError, match="ReportStatus"):
        report.decode(payload[:-1])
    with pytest.raises(EncodeError, match="Status"):
        report({"ReportStatusRec": {"Status": 99, "Reserved": 0}}).encode()
