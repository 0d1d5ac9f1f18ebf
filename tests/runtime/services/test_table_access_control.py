"""AccessControl, row by row (AS5710 v1.1 and v1.0, AccessControl, protocol behaviour)."""

import pytest

from jausml.runtime import messages as core

from .state_tables import V1_0, Row, after, controlled, play, rows, unavailable

ACCEPTED = core.ConfirmControl(response_code=0)
NOT_AVAILABLE = core.ConfirmControl(response_code=1)
INSUFFICIENT = core.ConfirmControl(response_code=2)
RELEASED = core.RejectControl(response_code=0)
REJECTED = core.RejectControl(response_code=1)
CONTROL = core.ReportControl(subsystem_id=2, node_id=1, component_id=1, authority_code=50)
NO_CONTROL = core.ReportControl(subsystem_id=0, node_id=0, component_id=0, authority_code=10)


def request(authority):
    return core.RequestControl(authority_code=authority)


def row(name, *given, when, **expected):
    """A row of a component with default authority 10 that times out after 4 s."""
    settings = {"default_authority": 10, "control_timeout": 4, **expected.pop("settings", {})}
    return Row(name, given, when, settings=settings, **expected)


NOT_CONTROLLED = (
    row("NotControlled, RequestControl, unavailable: Confirm 1", unavailable,
        when=("client", request(255), NOT_AVAILABLE), controller=""),
    row("NotControlled, RequestControl, default > a: Confirm 2",
        when=("client", request(9), INSUFFICIENT), controller="", authority=10),
    row("NotControlled, RequestControl, default = a: Confirm 0",
        when=("client", request(10), ACCEPTED), controller="client", authority=10),
    row("NotControlled, RequestControl, default < a: Confirm 0",
        when=("client", request(50), ACCEPTED), controller="client", authority=50),
    row("NotControlled, ReleaseControl, unavailable, no emergency client: Reject 1", unavailable,
        when=("client", core.ReleaseControl(), REJECTED)),
    row("NotControlled, ReleaseControl, unavailable, emergency client: Reject 0",
        ("client", core.SetEmergency()), when=("client", core.ReleaseControl(), RELEASED)),
    row("NotControlled, ReleaseControl, unavailable, v1.0: Reject 0", unavailable,
        when=("client", core.ReleaseControl(), RELEASED), version=V1_0),
    row("NotControlled, ReleaseControl, available: Reject 0",
        when=("client", core.ReleaseControl(), RELEASED)),
    row("NotControlled, SetAuthority: ignored",
        when=("client", core.SetAuthority(authority_code=20)), authority=10,
        counted="component.command_refused"),
    row("NotControlled, entry: authority is the default", *controlled(),
        when=("client", core.ReleaseControl(), RELEASED), authority=10),
)  # fmt: skip

CONTROLLED = (
    row("Controlled, RequestControl of another, unavailable: Confirm 1", *controlled(), unavailable,
        when=("rival", request(255), NOT_AVAILABLE), controller="client"),
    row("Controlled, RequestControl of the controller, unavailable: Confirm 1", *controlled(),
        unavailable, when=("client", request(50), NOT_AVAILABLE), controller="client"),
    row("Controlled, RequestControl of the controller, default <= a: Confirm 0", *controlled(),
        when=("client", request(10), ACCEPTED), controller="client", authority=10),
    row("Controlled, RequestControl of the controller: the timer restarts", *controlled(),
        after(3.9), ("client", request(50)), when=after(3.9), controller="client"),
    row("Controlled, RequestControl of the controller, default > a: Reject 0", *controlled(),
        when=("client", request(9), RELEASED), controller="", authority=10),
    row("Controlled, RequestControl of another, current < a: Reject 0 to old, Confirm 0 to new",
        *controlled(), when=("rival", request(51)),
        then={"client": [RELEASED], "rival": [ACCEPTED]}, controller="rival", authority=51),
    row("Controlled, RequestControl of another, current < a: the timer restarts", *controlled(),
        after(3.9), ("rival", request(51)), when=after(3.9), controller="rival"),
    row("Controlled, RequestControl of another, current = a: Confirm 2", *controlled(),
        when=("rival", request(50), INSUFFICIENT), controller="client", authority=50),
    row("Controlled, RequestControl of another, current > a: Confirm 2", *controlled(),
        when=("rival", request(49), INSUFFICIENT), controller="client"),
    row("Controlled, SetAuthority of the controller, a = current: taken", *controlled(),
        when=("client", core.SetAuthority(authority_code=50)), authority=50),
    row("Controlled, SetAuthority of the controller, a = default: taken", *controlled(),
        when=("client", core.SetAuthority(authority_code=10)), authority=10),
    row("Controlled, SetAuthority of the controller, a > current: ignored", *controlled(),
        when=("client", core.SetAuthority(authority_code=51)), authority=50,
        counted="access_control.authority_ignored"),
    row("Controlled, SetAuthority of the controller, a < default: ignored", *controlled(),
        when=("client", core.SetAuthority(authority_code=9)), authority=50,
        counted="access_control.authority_ignored"),
    row("Controlled, SetAuthority of another: ignored", *controlled(),
        when=("rival", core.SetAuthority(authority_code=20)), authority=50,
        counted="component.command_refused"),
    row("Controlled, ReleaseControl of the controller, available: Reject 0", *controlled(),
        when=("client", core.ReleaseControl(), RELEASED), controller=""),
    row("Controlled, ReleaseControl of the controller, unavailable: Reject 1", *controlled(),
        unavailable, when=("client", core.ReleaseControl(), REJECTED), controller="client"),
    row("Controlled, ReleaseControl of another, available: ignored", *controlled(),
        when=("rival", core.ReleaseControl()), controller="client",
        counted="access_control.release_ignored"),
    row("Controlled, ReleaseControl of another, unavailable: ignored", *controlled(), unavailable,
        when=("rival", core.ReleaseControl()), controller="client",
        counted="access_control.release_ignored"),
    row("Controlled, ReleaseControl of another, unavailable, v1.0: Reject 1", *controlled(),
        unavailable, when=("rival", core.ReleaseControl(), REJECTED), controller="client",
        version=V1_0),
    row("Controlled, ReleaseControl of another, available, v1.0: ignored", *controlled(),
        when=("rival", core.ReleaseControl()), controller="client", version=V1_0),
    row("Controlled, Timedout, available: Reject 0", *controlled(), when=after(4.1),
        then={"client": [RELEASED]}, controller="", counted="access_control.timed_out"),
    row("Controlled, Timedout, unavailable: the timer restarts", *controlled(), unavailable,
        when=after(9.0), controller="client"),
    row("Controlled, timeout 0: never", *controlled(), when=after(3600.0), controller="client",
        settings={"control_timeout": 0}),
    row("Controlled, a command of another: ignored", *controlled(), when=("rival", core.Standby()),
        controller="client", counted="component.command_refused"),
)  # fmt: skip

QUERIES = (
    row("any, QueryControl, uncontrolled: 0.0.0 and the default authority",
        when=("bystander", core.QueryControl(), NO_CONTROL)),
    row("any, QueryControl, controlled: the controller and its authority", *controlled(),
        when=("bystander", core.QueryControl(), CONTROL)),
    row("any, QueryAuthority, uncontrolled: the default",
        when=("bystander", core.QueryAuthority(), core.ReportAuthority(authority_code=10))),
    row("any, QueryAuthority, controlled: the controller's", *controlled(),
        when=("bystander", core.QueryAuthority(), core.ReportAuthority(authority_code=50))),
    row("any, QueryTimeout: seconds",
        when=("bystander", core.QueryTimeout(), core.ReportTimeout(timeout=4))),
    row("any, QueryTimeout, disabled: 0",
        when=("bystander", core.QueryTimeout(), core.ReportTimeout(timeout=0)),
        settings={"control_timeout": 0}),
)  # fmt: skip


@rows(*NOT_CONTROLLED, *CONTROLLED, *QUERIES)
def test_row(world, row):
    play(world, row)


@pytest.mark.parametrize("version", [V1_0, (1, 1)])
def test_the_old_controller_hears_first_of_a_preemption(world, version):
    preempting = row(
        "preemption",
        *controlled(),
        when=("rival", request(51)),
        then={"client": [RELEASED], "rival": [ACCEPTED]},
        version=version,
    )
    stage = play(world, preempting)
    order = [code for _, to, code in stage.world.log[-2:] if to != stage.component.address]
    assert order == [core.RejectControl.CODE, core.ConfirmControl.CODE]


def test_stop_tells_the_controller(world):
    stage = play(world, row("start", when=controlled()[0], then={"client": [ACCEPTED]}))
    stage.component.stop()
    world.settle()
    assert stage.heard() == {"client": [RELEASED]}
    assert stage.peers["client"].ask(core.QueryControl(), stage.component) == []


def test_component_without_access_control_ignores_requests(world):
    component = world.started("1.1.1", services=())
    assert world.probe("2.1.1").ask(request(255), component) == []
    assert world.counters.snapshot()["component.unknown_message"] == 1
