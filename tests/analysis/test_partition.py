"""Which bridge carries which connections: the weight, the limits, and all other partitions."""

from functools import cache

import pytest
from sweeps import sweep

from jausml.generation.target import system_of
from jausml.language.model import read_models
from jausml.views.analysis.partition.plans import Planner
from jausml.views.analysis.partition.scale import Scale
from jausml.views.analysis.partition.weighing import Limits, Weighing
from jausml.views.analysis.report import report_of
from jausml.views.analysis.sizes import Assumptions
from tests.support.partitioned import HEAD, robot

FACTOR = 1.25
"""No proposal weighs more than this times the lightest of all partitions."""


def best(scale):
    """Returns the weight of the lightest of all partitions, those that hold the limits first."""

    @cache
    def lightest(left):
        if not left:
            return 0.0, 0.0
        first, *others = sorted(left)
        found = []
        for chosen in range(1 << len(others)):
            part = frozenset([first, *(o for at, o in enumerate(others) if chosen >> at & 1)])
            own, rest = scale.weight(part), lightest(left - part)
            found.append((round(own[0] + rest[0], 9), round(own[1] + rest[1], 9)))
        return min(found)

    return lightest(frozenset(range(len(scale.groups))))


def weight_of(scale, plan):
    """Returns the weight of what a plan has in the end."""
    number_of = {c: n for n, group in enumerate(scale.groups) for c in group.carriers}
    return scale.total([frozenset(number_of[c] for c in one.carriers) for one in plan.after])


def carried(plan):
    return {one.name: sorted(c.name for c in one.carriers) for one in plan.after}


@pytest.mark.parametrize(
    "seeds", sweep([range(4), range(4, 8), range(8, 28), range(28, 48)], every=4), ids=str
)
def test_no_partition_of_a_small_robot_is_much_better(system, seeds):
    """All partitions are counted: none holds more limits, few weigh less."""
    worse = 0
    cases = [
        (seed, limits) for seed in seeds for limits in (Limits(), Limits(most=3), Limits(load=0.01))
    ]
    for seed, limits in cases:
        whole = system(robot(4 + seed % 7, 1 + seed % 3, seed), head="")
        scale = Scale(Weighing(whole, Assumptions()), limits)
        # Names of groups are those of another reading of the limits: the order is the model's.
        own, least = weight_of(scale, planned(whole, scale, limits)), best(scale)
        assert own[0] == least[0], (seed, limits)
        assert own[1] <= FACTOR * least[1], (seed, limits)
        worse += own != least
    assert worse <= len(cases) / 10


def planned(whole, scale, limits):
    """Returns the proposal, of the groups of a scale."""
    plan = Planner(whole, Assumptions()).propose(limits)
    assert {c for one in plan.after for c in one.carriers} == set(scale.weighing.costs)
    return plan


@pytest.fixture(scope="module")
def vehicle():
    return system_of(read_models(["models/catvehicle/catvehicle.xmi"]).model)


def test_the_paper_s_vehicle_needs_one_bridge(vehicle):
    plan = Planner(vehicle, Assumptions()).propose(Limits())
    assert not plan.moved
    assert plan.excess == ()


def test_its_figures_before_are_those_of_the_report(vehicle):
    (bridge,) = report_of(vehicle, Assumptions()).bridges
    (before,) = Planner(vehicle, Assumptions()).propose(Limits()).before
    load = bridge.load
    assert before.share == pytest.approx(bridge.share)
    assert before.datagrams == pytest.approx(load.sent.packets + load.received.packets, rel=0.02)


def test_commands_to_one_component_stay_together(vehicle):
    plan = Planner(vehicle, Assumptions()).propose(Limits(most=1))
    assert ["speed_command", "steering_command"] in carried(plan).values()
    assert len(plan.after) == 6
    assert [text.split()[-3:] for text in plan.excess] == [["more", "than", "1"]]


def test_who_is_commanded_keeps_its_jaus_id(vehicle):
    plan = Planner(vehicle, Assumptions()).propose(Limits(most=2))
    assert "cruise_speed" in carried(plan)["bridge"]


def test_what_a_person_wants_is_held(vehicle):
    wish = Limits(together=(("odometry", "pose"),), inside=(("bridge.steering_angle", "nav"),))
    plan = Planner(vehicle, Assumptions()).propose(wish)
    assert "steering_angle" in carried(plan)["nav"]
    assert any({"odometry", "pose"} <= set(names) for names in carried(plan).values())
    for names in (("odometry", "nothing"), ("bridge.nothing",)):
        with pytest.raises(LookupError, match="no connection"):
            Planner(vehicle, Assumptions()).propose(Limits(together=(names,)))


@pytest.mark.slow
@pytest.mark.parametrize("most", sweep([30, 50], every=2, rest=0))
def test_150_connections_are_cut_into_full_bridges(system, most):
    plan = Planner(system(robot(150, 3), head=""), Assumptions()).propose(Limits(most=most))
    assert len(plan.after) == 150 / most
    assert plan.excess == ()


def test_40_connections_on_three_hosts_go_where_their_nodes_are(system):
    planner = Planner(system(robot(40, 3, seed=1), head=""), Assumptions())
    plan = planner.propose(Limits(most=14))
    assert len({one.host for one in plan.after}) == 3
    before, after = (sum(one.remote for one in some) for some in (plan.before, plan.after))
    assert after < 0.7 * before
    # What shares an event was not parted.
    assert sum(one.datagrams for one in plan.after) == pytest.approx(plan.before[0].datagrams)


def test_again_it_is_the_same(system):
    whole = system(robot(40, 3), head="")
    first, again = (carried(Planner(whole, Assumptions()).propose(Limits(most=9))) for _ in "12")
    assert first == again


TWO = """
component one {{ address: 100.1.1  provides: VelocityStateSensor, PrimitiveDriver }}
node drive {{
    publisher go {{ topic: go  type: geometry_msgs/TwistStamped }}
    subscription speed {{ topic: speed  type: geometry_msgs/TwistStamped }}
}}
bridge left {{
    address: 100.1.2  uses: VelocityStateSensor  authority: 10
    connection speed {{
        map: velocity_state_twist  exchange: periodicEvent  peers: one  topic speed
    }}
}}
bridge right {{
    address: 100.1.3  uses: PrimitiveDriver  authority: {authority}
    connection go {{
        map: wrench_effort_stamped  direction: rosToJaus  peers: one  silenceTimeout: 1  topic go
    }}
}}
"""


def test_bridges_become_one_where_safety_agrees(system):
    plan = Planner(system(TWO.format(authority=10), HEAD), Assumptions()).propose(Limits())
    assert len(plan.after) == len(plan.gone) == 1


def test_bridges_whose_authorities_differ_are_not_mixed(system):
    planner = Planner(system(TWO.format(authority=20), HEAD), Assumptions())
    assert sum(map(len, carried(planner.propose(Limits())).values())) == 2
    (go,) = (c for c in planner.propose(Limits()).before[1].carriers)
    plan = planner.assigned({go: "left"})
    assert plan.faults == ("left cannot carry go: authority is 10 here, 20 there",)
