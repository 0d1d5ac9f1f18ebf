"""EnhancedAccessControl, row by row (IOP, EnhancedAccessControl v1.1, protocol behaviour)."""

from jausml.runtime import ServiceIdentity
from jausml.runtime import messages as core
from jausml.runtime.services.handoff import MAX_REQUESTS, PAUSE

from .state_tables import Row, after, controlled, play, rows, unavailable

SERVICE = ServiceIdentity("urn:jaus:jss:iop:EnhancedAccessControl", 1, 1)
GRANTED, NOT_AVAILABLE, TIMEOUT, DENIED, QUEUED, DEFERRED, INSUFFICIENT = range(7)
GRANT, DENY, WAIT = range(3)
ACCEPTED = core.ConfirmControl(response_code=0)
RELEASED = core.RejectControl(response_code=0)
NO_REQUEST = 255
RIVAL = core.RequestReleaseControl.RequestReleaseControlRec(0, 3, 1, 1, 20, "shift ends")
BYSTANDER = core.RequestReleaseControl.RequestReleaseControlRec(1, 4, 1, 1, 20, "shift ends")


def request(authority=20):
    return core.RequestHandoff(authority_code=authority, explanation="shift ends")


def answer(code, number=NO_REQUEST):
    return core.ConfirmHandoffRequest(id_=number, response_code=code)


def asked(*waiting):
    return core.RequestReleaseControl(request_release_control_list=list(waiting))


def decide(*decisions):
    record = core.ConfirmReleaseControl.ReleaseControlRec
    return core.ConfirmReleaseControl(
        release_control_list=[record(*decision) for decision in decisions]
    )


def row(name, *given, when, **expected):
    """A row of a component with default authority 10."""
    settings = {
        "default_authority": 10,
        "control_timeout": 0,
        "handoff_timeout": 6,
        "enhanced_timeout": 4,
        **expected.pop("settings", {}),
    }
    return Row(name, given, when, settings=settings, services=(SERVICE,), **expected)


told = after(PAUSE + 0.01)
waits = (*controlled(), ("rival", request()), told)
both_wait = (*waits, ("bystander", request()), told)

TABLE = (
    row("NotControlled, RequestHandoff: Confirm DENIED", when=("rival", request(), answer(DENIED)),
        controller=""),
    row("NotControlled, RemoveHandoffRequest: Confirm DENIED",
        when=("rival", core.RemoveHandoffRequest(id_=0), answer(DENIED))),
    row("NotControlled, RequestHandoff, unavailable: Confirm NOT_AVAILABLE", unavailable,
        when=("rival", request(), answer(NOT_AVAILABLE))),
    row("NotControlled, RemoveHandoffRequest, unavailable: Confirm NOT_AVAILABLE", unavailable,
        when=("rival", core.RemoveHandoffRequest(id_=0), answer(NOT_AVAILABLE))),
    row("Controlled, RequestHandoff: Confirm QUEUED", *controlled(),
        when=("rival", request(), answer(QUEUED, 0)), controller="client"),
    row("Controlled, RequestHandoff: the controller is asked", *controlled(), ("rival", request()),
        when=told, then={"client": [asked(RIVAL)]}, controller="client"),
    row("Controlled, RequestHandoff of a second client: the controller is told both", *waits,
        ("bystander", request()), when=told, then={"client": [asked(RIVAL, BYSTANDER)]}),
    row("Controlled, RequestHandoff again: same number", *waits,
        when=("rival", request(), answer(QUEUED, 0))),
    row("Controlled, RequestHandoff, default > a: Confirm INSUFFICIENT_AUTHORITY", *controlled(),
        when=("rival", request(9), answer(INSUFFICIENT))),
    row("Controlled, RequestHandoff, default > a, queued: removed, the controller is told", *waits,
        ("rival", request(9)), when=told, then={"client": [asked()]}),
    row("Controlled, RequestHandoff of the controller: Confirm GRANTED, its authority",
        *controlled(), when=("client", request(20), answer(GRANTED)), controller="client",
        authority=20),
    row("Controlled, RequestHandoff, unavailable: Confirm NOT_AVAILABLE", *controlled(),
        unavailable, when=("rival", request(), answer(NOT_AVAILABLE))),
    row("Controlled, RemoveHandoffRequest, queued: Confirm DENIED", *waits,
        when=("rival", core.RemoveHandoffRequest(id_=0), answer(DENIED, 0))),
    row("Controlled, RemoveHandoffRequest of another's request: ignored", *both_wait,
        when=("bystander", core.RemoveHandoffRequest(id_=0)), counted="handoff.removal_ignored"),
    row("Controlled, ConfirmReleaseControl GRANTED: control passes", *waits,
        when=("client", decide((0, GRANT))),
        then={"client": [RELEASED], "rival": [answer(GRANTED, 0)]}, controller="rival",
        authority=20),
    row("Controlled, ConfirmReleaseControl GRANTED: the others are denied", *both_wait,
        when=("client", decide((1, GRANT))), then={"client": [RELEASED],
        "rival": [answer(DENIED, 0)], "bystander": [answer(GRANTED, 1)]}, controller="bystander"),
    row("Controlled, ConfirmReleaseControl GRANTED twice: the first has control", *both_wait,
        when=("client", decide((1, GRANT), (0, GRANT))), then={"client": [RELEASED],
        "rival": [answer(DENIED, 0)], "bystander": [answer(GRANTED, 1)]}, controller="bystander"),
    row("Controlled, ConfirmReleaseControl DENIED: Confirm DENIED", *waits,
        when=("client", decide((0, DENY))), then={"rival": [answer(DENIED, 0)]},
        controller="client"),
    row("Controlled, ConfirmReleaseControl WAIT: Confirm DEFERRED", *waits,
        when=("client", decide((0, WAIT))), then={"rival": [answer(DEFERRED, 0)]},
        controller="client"),
    row("Controlled, ConfirmReleaseControl of a client that does not control: ignored", *waits,
        when=("rival", decide((0, GRANT))), counted="handoff.decision_ignored",
        controller="client"),
    row("Controlled, ConfirmReleaseControl of an unknown request: ignored", *waits,
        when=("client", decide((7, GRANT))), counted="handoff.decision_ignored",
        controller="client"),
    row("Controlled, a decision on a request that has ended meets no newer one", *waits,
        ("rival", core.RemoveHandoffRequest(id_=0)), ("bystander", request()),
        when=("client", decide((0, GRANT))), counted="handoff.decision_ignored",
        controller="client"),
    row("Controlled, no decision: TIMEOUT, and the controller is told", *controlled(),
        ("rival", request()), *(after(3), ("rival", request()), told), when=after(3.3, 66),
        then={"client": [asked()], "rival": [answer(TIMEOUT, 0)]}, controller="client"),
    row("Controlled, no decision after WAIT: the time begins anew", *controlled(),
        ("rival", request()), *(after(3), ("rival", request()), ("client", decide((0, WAIT)))),
        when=after(3.5, 70), then={"client": [asked(RIVAL)]}),
    row("Controlled, the request is not sent again: DENIED, and the controller is told", *waits,
        when=after(4.2, 42), then={"client": [asked()], "rival": [answer(DENIED, 0)]}),
    row("Controlled, time-outs of 0 never come", *waits, when=after(300),
        settings={"handoff_timeout": 0, "enhanced_timeout": 0}),
    row("the controller releases control: Confirm DENIED", *waits,
        when=("client", core.ReleaseControl()),
        then={"client": [RELEASED], "rival": [answer(DENIED, 0)]}, controller=""),
    row("a higher authority takes control: it is asked", *waits,
        ("bystander", core.RequestControl(authority_code=60)), when=told,
        then={"bystander": [asked(RIVAL)]}, controller="bystander"),
    row("a client that waits takes control by its authority: Confirm GRANTED", *waits,
        when=("rival", core.RequestControl(authority_code=60)),
        then={"client": [RELEASED], "rival": [ACCEPTED, answer(GRANTED, 0)]}, controller="rival"),
    row("a client that is granted control has asked in vain before: that is judged no more", *waits,
        *[("rival", core.RequestControl(authority_code=9))] * 15, ("client", decide((0, GRANT))),
        when=after(1.1), controller="rival", authority=20),
    row("QueryHandoffTimeout",
        when=("rival", core.QueryHandoffTimeout(), core.ReportHandoffTimeout(timeout=6))),
    row("QueryEnhancedTimeout",
        when=("rival", core.QueryEnhancedTimeout(), core.ReportEnhancedTimeout(timeout=4))),
)  # fmt: skip


@rows(*TABLE)
def test_row(world, row):
    play(world, row)


def test_a_flood_of_requests_is_bounded(world):
    stage = play(world, TABLE[4])
    for number in range(5, 5 + 2 * MAX_REQUESTS):
        world.probe(f"{number}.1.1", strict=False).send(request(), stage.component)
    world.run(1.0)
    asked_for = [
        message
        for message in stage.heard()["client"]
        if isinstance(message, core.RequestReleaseControl)
    ]
    assert len(asked_for) == 1
    assert len(asked_for[0].request_release_control_list) == MAX_REQUESTS
    assert world.counters.snapshot()["handoff.too_many"] == MAX_REQUESTS + 1


def test_numbers_are_not_given_again_soon(world):
    stage = play(world, TABLE[4])
    numbers = [0]
    for _ in range(3):
        stage.do(("rival", core.RemoveHandoffRequest(id_=numbers[-1])))
        stage.heard()
        stage.do(("rival", request()))
        numbers.append(stage.heard()["rival"][0].id_)
    assert numbers == [0, 1, 2, 3]
