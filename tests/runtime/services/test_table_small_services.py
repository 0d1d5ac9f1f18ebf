"""Liveness, Time and ListManager, row by row (AS5710 v1.1 and v1.0; IOP: UnsolicitedHeartbeat)."""

from datetime import datetime, timedelta, timezone

import pytest

from jausml.runtime import JausComponent, ListElement, Scope, ServiceIdentity, chain
from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress
from jausml.runtime.services.list_elements import ELEMENTS_OF_DRIVERS
from jausml.runtime.services.list_manager import ListManagerService

from .state_tables import V1_0, Row, after, controlled, play, ready, rows

UTC = timezone.utc
START = datetime(2026, 1, 31, 23, 59, 58, 250_000, tzinfo=UTC)
LIST_MANAGER = ServiceIdentity("urn:jaus:jss:core:ListManager", 1, 1)
REFUSED = "component.command_refused"
WAYPOINT = b"\x0c\x04\x01"


class Robot(JausComponent):
    """Lives in the world's time and takes elements that begin with SetGlobalWaypoint."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.told = []
        self.changes = 0

    def host_time(self):
        return START + timedelta(seconds=self.loop.now() - 1000.0)

    def on_set_time(self, time):
        self.told.append(time)

    def supports_element(self, element):
        return element.message_code == 0x040C

    def on_list_changed(self):
        self.changes += 1


# ---- Liveness --------------------------------------------------------------------------------

PULSE = core.ReportHeartbeatPulse()


@rows(
    *(
        Row(
            f"QueryHeartbeatPulse {version}: ReportHeartbeatPulse",
            when=("client", core.QueryHeartbeatPulse(), PULSE),
            version=version,
        )
        for version in ((1, 1), V1_0)
    ),
    Row("no heartbeat unasked by default", when=after(100.0)),
)
def test_liveness(world, row):
    play(world, row)


@pytest.mark.parametrize("spelling", ["Liveness", "Liveliness"])
def test_liveness_of_v1_0_is_spelt_both_ways(world, spelling):
    service = ServiceIdentity(f"urn:jaus:jss:core:{spelling}", 1, 0)
    component = world.started("1.1.1", services=(service,))
    assert world.probe("2.1.1").ask(core.QueryHeartbeatPulse(), component) == [PULSE]


@pytest.mark.parametrize(
    ("urns", "settings", "count", "destination"),
    [
        pytest.param((), {}, 0, None, id="off without the service"),
        pytest.param(("iop:UnsolicitedHeartbeat",), {}, 11, (1, 255, 255), id="on with it: 1 Hz"),
        pytest.param((), {"heartbeat_rate": 2.0}, 21, (1, 255, 255), id="on by the setting"),
        pytest.param(("iop:UnsolicitedHeartbeat",), {"heartbeat_rate": 0.0}, 0, None,
            id="off by the setting"),
        pytest.param((), {"heartbeat_rate": 1.0, "heartbeat_scope": Scope.SYSTEM}, 11,
            (65535, 255, 255), id="to the whole system"),
    ],
)  # fmt: skip
def test_unsolicited_heartbeat(world, urns, settings, count, destination):
    services = tuple(ServiceIdentity(f"urn:jaus:jss:{urn}", 1, 1) for urn in urns)
    component = world.started("1.1.1", services=services, **settings)
    world.run(10.0, step=0.5)
    component.stop()
    world.run(10.0, step=0.5)
    assert world.count(PULSE.CODE) == count
    heard = {to for _, to, code in world.log if code == PULSE.CODE}
    assert heard == ({JausAddress(*destination)} if destination else set())


# ---- Time ------------------------------------------------------------------------------------


def stamp(hour, minutes, seconds, milliseconds, day):
    return {"milliseconds": milliseconds, "seconds": seconds, "minutes": minutes, "hour": hour} | {
        "day": day
    }


def set_time(time=None, date=None):
    return (
        "client",
        core.SetTime(
            time_stamp=None if time is None else core.SetTime.TimeStamp(**stamp(*time)),
            date_stamp=None if date is None else core.SetTime.DateStamp(*date),
        ),
    )


def raw_time(time_bits, date_bits):
    payload = b"\x11\x00\x03" + time_bits.to_bytes(4, "little") + date_bits.to_bytes(2, "little")
    return lambda stage: stage.peers["client"].send_bytes(payload, stage.component)


def reported(time=None, date=None):
    return core.ReportTime(
        time_stamp=None if time is None else core.ReportTime.TimeStamp(**stamp(*time)),
        date_stamp=None if date is None else core.ReportTime.DateStamp(*date),
    )


TIME_REPORTS = tuple(
    Row(
        f"QueryTime, presence vector {bits}: {name}",
        when=("rival", core.QueryTime(presence_vector=bits), reported(time, date)),
    )
    for bits, name, time, date in (
        (3, "time and date", (23, 59, 58, 250, 31), (31, 1, 26)),
        (1, "time and day of month", (23, 59, 58, 250, 31), None),
        (2, "date", None, (31, 1, 26)),
        (0, "neither", None, None),
    )
)

TIME_COMMANDS = tuple(
    (Row(f"SetTime, {name}", controlled(), when=set_time(time, date)), told)
    for name, time, date, told in (
        ("time and date", (1, 2, 3, 999, 29), (29, 2, 28),
            datetime(2028, 2, 29, 1, 2, 3, 999_000, tzinfo=UTC)),
        ("date alone: the time of day stays", None, (1, 3, 30), START.replace(2030, 3, 1)),
        ("time alone, today", (1, 0, 0, 0, 31), None, datetime(2026, 1, 31, 1, tzinfo=UTC)),
        ("time alone, the next month's", (0, 0, 1, 0, 1), None,
            datetime(2026, 2, 1, 0, 0, 1, tzinfo=UTC)),
        ("time alone, a day before", (12, 0, 0, 0, 30), None,
            datetime(2026, 1, 30, 12, tzinfo=UTC)),
        ("the last date that fits", (0, 0, 0, 0, 31), (31, 12, 127),
            datetime(2127, 12, 31, tzinfo=UTC)),
    )
)  # fmt: skip


def bits(milliseconds=0, seconds=0, minutes=0, hour=0, day=1):
    return milliseconds | seconds << 10 | minutes << 16 | hour << 22 | day << 27


FIRST_OF_MAY = 1 | 5 << 5 | 26 << 9

TIME_REFUSALS = (
    Row("SetTime without control: ignored", when=set_time(date=(1, 1, 30)), counted=REFUSED),
    Row("SetTime of another: ignored", controlled(),
        when=("rival", core.SetTime(date_stamp=core.SetTime.DateStamp(1, 1, 30))), counted=REFUSED),
    *(
        Row(f"SetTime, {name}: refused", controlled(), when=when, counted="time.refused")
        for name, when in (
            ("neither time nor date", set_time()),
            ("30 February", set_time(date=(30, 2, 26))),
            ("days that contradict each other", set_time((0, 0, 0, 0, 2), (3, 3, 26))),
            ("hour 24", raw_time(bits(hour=24), FIRST_OF_MAY)),
            ("minute 60", raw_time(bits(minutes=60), FIRST_OF_MAY)),
            ("second 60", raw_time(bits(seconds=60), FIRST_OF_MAY)),
            ("millisecond 1000", raw_time(bits(milliseconds=1000), FIRST_OF_MAY)),
            ("day 0", raw_time(bits(day=0), 0 | 5 << 5)),
            ("month 13", raw_time(bits(), 1 | 13 << 5)),
        )
    ),
)  # fmt: skip


@rows(*TIME_REPORTS)
def test_time_reports(world, row):
    play(world, row, Robot)


@pytest.mark.parametrize(("row", "told"), TIME_COMMANDS, ids=[row.name for row, _ in TIME_COMMANDS])
def test_time_is_set(world, row, told):
    stage = play(world, row, Robot)
    assert stage.component.told == [told]
    world.run(2.0, step=0.5)
    assert stage.component.current_time == told + timedelta(seconds=2)
    assert stage.component.host_time() == START + timedelta(seconds=2), "the host's is left alone"


@pytest.mark.parametrize("month", [2, 3])
def test_a_time_alone_is_the_nearest_one_of_that_day(world, month):
    """One that was sent just before midnight comes just after it; February has no day 31."""
    late = set_time((23, 59, 59, 0, 31))
    new_month = set_time((0, 0, 1, 0, 1), (1, month, 26))
    row = Row("SetTime, the last month's", (*controlled(), new_month), when=late)
    stage = play(world, row, Robot)
    assert stage.component.told[-1] == datetime(2026, 1, 31, 23, 59, 59, tzinfo=UTC)


@rows(*TIME_REFUSALS)
def test_time_is_not_set(world, row):
    stage = play(world, row, Robot)
    assert stage.component.told == []
    assert stage.component.current_time == START


# ---- ListManager -----------------------------------------------------------------------------


def element(uid, previous, following, data=WAYPOINT, data_format=0):
    return core.SetElement.ElementRec(
        element_uid=uid,
        previous_uid=previous,
        next_uid=following,
        element_data=core.SetElement.ElementData(data_format, data),
    )


def sets(*elements, request=1, who="client"):
    return (
        who,
        core.SetElement(
            request_id_rec=core.SetElement.RequestIDRec(request_id=request),
            element_list=list(elements),
        ),
    )


def deletes(*uids, request=2, who="client"):
    return (
        who,
        core.DeleteElement(
            request_id_rec=core.DeleteElement.RequestIDRec(request_id=request),
            delete_element_list=[
                core.DeleteElement.DeleteElementRec(element_uid=uid) for uid in uids
            ],
        ),
    )


ABC = sets(element(10, 0, 20), element(20, 10, 30), element(30, 20, 0))
CIRCLE = sets(element(10, 0, 20), element(20, 10, 30), element(30, 20, 10))
LINE_LINKS = [(10, 0, 20), (20, 10, 30), (30, 20, 0)]


def row(name, *given, when, **expected):
    return Row(
        name,
        (*controlled(), *given),
        when,
        services=(LIST_MANAGER,),
        settings={"max_list_elements": 6, "control_timeout": 0},
        **expected,
    )


def taken(name, *given, when, links, request=1):
    """A request that is confirmed, with the list that it leads to."""
    when = (*when, core.ConfirmElementRequest(request_id=request))
    return pytest.param(row(name, *given, when=when), links, id=name)


def refused(name, *given, when, code, links=LINE_LINKS, request=1):
    """A request that is rejected and changes nothing."""
    when = (*when, core.RejectElementRequest(request_id=request, response_code=code))
    refusal = row(name, *given, when=when, counted="list_manager.rejected")
    return pytest.param(refusal, links, id=name)


def ignored(name, *given, when, links=LINE_LINKS, counted=REFUSED):
    return pytest.param(row(name, *given, when=when, counted=counted), links, id=name)


LISTS = [
    taken("SetElement: a list", when=ABC, links=LINE_LINKS),
    taken("SetElement in any order: links make the order",
        when=sets(element(30, 20, 0), element(10, 0, 20), element(20, 10, 30)), links=LINE_LINKS),
    taken("SetElement: one element", when=sets(element(7, 0, 0)), links=[(7, 0, 0)]),
    taken("SetElement: a circular list, the tail's next is the head", when=CIRCLE,
        links=[(10, 0, 20), (20, 10, 30), (30, 20, 10)]),
    taken("SetElement, append: the former tail's next is updated", ABC,
        when=sets(element(40, 30, 0)),
        links=[(10, 0, 20), (20, 10, 30), (30, 20, 40), (40, 30, 0)]),
    taken("SetElement, insert: both neighbours are updated", ABC, when=sets(element(15, 10, 20)),
        links=[(10, 0, 15), (15, 10, 20), (20, 15, 30), (30, 20, 0)]),
    taken("SetElement, insert at the head: the former head's previous is updated", ABC,
        when=sets(element(5, 0, 10)), links=[(5, 0, 10), (10, 5, 20), (20, 10, 30), (30, 20, 0)]),
    taken("SetElement, two inserted at the head", ABC,
        when=sets(element(4, 0, 5), element(5, 4, 10)),
        links=[(4, 0, 5), (5, 4, 10), (10, 5, 20), (20, 10, 30), (30, 20, 0)]),
    taken("SetElement, replace: the same place", ABC,
        when=sets(element(20, 10, 30, WAYPOINT + b"new")), links=LINE_LINKS),
    taken("SetElement, an element moves: the gap is closed", ABC,
        when=sets(element(10, 30, 0), element(20, 0, 30)),
        links=[(20, 0, 30), (30, 20, 10), (10, 30, 0)]),
    taken("SetElement, append that closes the circle", ABC, when=sets(element(40, 30, 10)),
        links=[(10, 0, 20), (20, 10, 30), (30, 20, 40), (40, 30, 10)]),
    taken("SetElement, insert at the head of a circle: the tail's next follows", CIRCLE,
        when=sets(element(5, 0, 10)), links=[(5, 0, 10), (10, 5, 20), (20, 10, 30), (30, 20, 5)]),
    taken("SetElement, the circle is opened", CIRCLE, when=sets(element(30, 20, 0)),
        links=LINE_LINKS),
    taken("DeleteElement in the middle: the neighbours are joined", ABC, when=deletes(20),
        links=[(10, 0, 30), (30, 10, 0)], request=2),
    taken("DeleteElement, head: the next one is the head", ABC, when=deletes(10),
        links=[(20, 0, 30), (30, 20, 0)], request=2),
    taken("DeleteElement, head of a circle: the tail's next follows", CIRCLE, when=deletes(10),
        links=[(20, 0, 30), (30, 20, 20)], request=2),
    taken("DeleteElement, all but one of a circle: no element follows itself", CIRCLE,
        when=deletes(10, 30), links=[(20, 0, 0)], request=2),
    taken("DeleteElement 65535: all", ABC, when=deletes(65535), links=[], request=2),
    taken("DeleteElement 65535, empty: confirmed", when=deletes(65535), links=[], request=2),
    refused("Reject 1: UID 0", ABC, when=sets(element(0, 30, 0)), code=1),
    refused("Reject 1: UID 65535", ABC, when=sets(element(65535, 30, 0)), code=1),
    refused("Reject 1: a UID twice", ABC, when=sets(element(40, 30, 0), element(40, 30, 0)),
        code=1),
    refused("Reject 1: DeleteElement 0", ABC, when=deletes(0), code=1, request=2),
    refused("Reject 2: unknown previous", ABC, when=sets(element(40, 99, 0)), code=2),
    refused("Reject 2: previous is itself", ABC, when=sets(element(40, 40, 0)), code=2),
    refused("Reject 2: previous 65535", ABC, when=sets(element(40, 65535, 0)), code=2),
    refused("Reject 2: a second head", ABC, when=sets(element(40, 0, 0)), code=2),
    refused("Reject 2: no head", when=sets(element(1, 2, 2), element(2, 1, 1)), code=2, links=[]),
    refused("Reject 3: unknown next", ABC, when=sets(element(40, 30, 99)), code=3),
    refused("Reject 3: next is itself", ABC, when=sets(element(40, 30, 40)), code=3),
    refused("Reject 3: elements cut off", ABC, when=sets(element(40, 10, 0)), code=3),
    refused("Reject 3: a circle that does not end at the head",
        when=sets(element(1, 0, 2), element(2, 1, 3), element(3, 2, 2)), code=3, links=[]),
    refused("Reject 4: another message", ABC, when=sets(element(40, 30, 0, b"\x0d\x04")), code=4),
    refused("Reject 4: user defined", ABC, when=sets(element(40, 30, 0, WAYPOINT, 1)), code=4),
    refused("Reject 4: one of several; none is set", ABC,
        when=sets(element(40, 30, 50), element(50, 40, 0, b"")), code=4),
    refused("Reject 5: DeleteElement, not found", ABC, when=deletes(99), code=5, request=2),
    refused("Reject 5: one of several; none is deleted", ABC, when=deletes(10, 99), code=5,
        request=2),
    refused("Reject 6: out of memory", ABC,
        when=sets(element(1, 30, 2), element(2, 1, 3), element(3, 2, 4), element(4, 3, 0)), code=6),
    refused("Reject 7: SetElement without elements", ABC, when=sets(), code=7),
    refused("Reject 7: DeleteElement without elements", ABC, when=deletes(), code=7, request=2),
    ignored("SetElement of another: ignored", ABC, when=sets(element(40, 30, 0), who="rival")),
    ignored("DeleteElement of another: ignored", ABC, when=deletes(10, who="rival")),
]  # fmt: skip


@pytest.mark.parametrize(("row", "links"), LISTS)
def test_list(world, row, links):
    stage = play(world, row, Robot)
    elements = stage.component.elements
    assert [
        (list_element.uid, list_element.previous_uid, list_element.next_uid)
        for list_element in elements
    ] == links
    assert len(elements) == len(links)
    assert elements.circular is (bool(links) and links[-1][2] != 0)
    confirmed = world.count(core.ConfirmElementRequest.CODE)
    assert stage.component.changes == confirmed


@rows(
    row("QueryElement: the element", ABC, when=("rival", core.QueryElement(element_uid=20),
        core.ReportElement(element_uid=20, previous_uid=10, next_uid=30,
        element_data=core.ReportElement.ElementData(0, WAYPOINT)))),
    row("QueryElement, unknown: silence", ABC, when=("rival", core.QueryElement(element_uid=21))),
    row("QueryElementList: the order",
        sets(element(30, 0, 10), element(10, 30, 20), element(20, 10, 0)),
        when=("rival", core.QueryElementList(), core.ReportElementList(
            [core.ReportElementList.ElementListRec(element_uid=uid) for uid in (30, 10, 20)]))),
    row("QueryElementList, empty",
        when=("rival", core.QueryElementList(), core.ReportElementList())),
    row("QueryElementCount", ABC,
        when=("rival", core.QueryElementCount(), core.ReportElementCount(element_count=3))),
    Row("SetElement in Ready: set", ready(), services=(LIST_MANAGER,),
        when=(*ABC, core.ConfirmElementRequest(request_id=1))),
    Row("SetElement without control: ignored", when=ABC, counted=REFUSED, services=(LIST_MANAGER,)),
)  # fmt: skip
def test_list_queries_and_other_states(world, row):
    play(world, row, Robot)


@pytest.mark.parametrize("urn", sorted(ListManagerService.urns))
def test_list_manager_of_every_set(world, urn):
    when = (*ABC, core.ConfirmElementRequest(request_id=1))
    services = (ServiceIdentity(urn, 1, 0),)
    play(world, Row(urn, controlled(), when, services=services, version=V1_0), Robot)


@pytest.mark.parametrize("urn", sorted(ELEMENTS_OF_DRIVERS))
def test_list_takes_the_elements_of_its_driver(world, urn):
    driver = ServiceIdentity(urn, 1, 0)
    data = ELEMENTS_OF_DRIVERS[urn].to_bytes(2, "little")
    then = {"client": [core.ConfirmElementRequest(request_id=1)]}
    services = (LIST_MANAGER, driver)
    play(world, Row(urn, controlled(), sets(element(1, 0, 0, data)), then, services=services))


def test_list_manager_alone_takes_nothing(world):
    then = {"client": [core.RejectElementRequest(request_id=1, response_code=4)]}
    play(world, Row("alone", controlled(), ABC, then, services=(LIST_MANAGER,)))


def test_element_of_an_unknown_format_is_refused_whatever_the_component_says(world):
    class Taker(Robot):
        def supports_element(self, _element):
            return True

    then = {"client": [core.RejectElementRequest(request_id=1, response_code=4)]}
    payload = bytearray(sets(element(1, 0, 0, b"x", data_format=1))[1].encode())
    payload[10] = 255

    def when(stage):
        stage.peers["client"].send_bytes(bytes(payload), stage.component)

    play(world, Row("format 255", controlled(), when, then, services=(LIST_MANAGER,)), Taker)


def test_chain_links_elements():
    assert chain([(1, b"a", 0), (2, b"b", 1)], circular=True) == [
        ListElement(1, 0, 2, b"a", 0),
        ListElement(2, 1, 1, b"b", 1),
    ]
    assert chain([(1, b"a", 0)], circular=True) == [ListElement(1, 0, 0, b"a", 0)]
