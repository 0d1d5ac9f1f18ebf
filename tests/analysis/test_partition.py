"""Partitions: what stays together, how many bridges there are, and what becomes of the model."""

from __future__ import annotations

import pytest

from jausml.language.semantics.hosts import host_of
from jausml.views.analysis.assumptions import Assumptions
from jausml.views.analysis.formats.partition import render
from jausml.views.analysis.partition import LARGEST_SHARE, UnsplittableError, is_heavy, propose
from jausml.views.analysis.splitting import AddressesExhaustedError, split

from .conftest import HEAD

VEHICLE = """
component vehicle {
    address: 10.1.1
    provides: PrimitiveDriver, VelocityStateDriver, VelocityStateSensor, LocalPoseSensor
}
"""
STATION = (
    VEHICLE
    + """
bridge station {
    address: 10.1.2
    authority: 7
    namespace: desk
    provides: CostMap2D
    uses: PrimitiveDriver, VelocityStateDriver, VelocityStateSensor
    quantity max_speed { value: 3.0  units: "m/s" }
    connection effort { map: wrench_effort  peers: vehicle  topic `~/effort` }
    connection speed { map: velocity_command  peers: vehicle  topic speed }
    connection velocity { map: velocity_state  peers: vehicle  rate: 20  topic `~/odom` }
    connection costs {
        map: cost_map  direction: rosToJaus  exchange: everyChangeEvent  topic grid
    }
}

component viewer {
    address: 10.1.9
    uses: CostMap2D
    service_connection map { provider: station  message: ReportCostMap2D  exchange: everyChange }
}
"""
)
GRIDS = Assumptions(rates={"costs": 5.0}, lengths={"costs": 60_000})


def names(proposal):
    return [
        [[each.name for each in group.connections] for group in part.groups]
        for part in proposal.parts
    ]


def test_what_one_component_controls_stays_together(system):
    (part,) = propose(system(STATION), Assumptions(), 1).parts
    together = next(each for each in part.groups if len(each.connections) > 1)
    assert [each.name for each in together.connections] == ["effort", "speed"]
    assert together.reasons == ("one bridge alone can hold control of vehicle",)


def test_commands_are_parted_from_what_is_heavy(system):
    proposal = propose(system(STATION), GRIDS, None)
    assert names(proposal) == [[["effort", "speed"], ["velocity"]], [["costs"]]]
    (heavy,) = proposal.parts[1].groups
    assert is_heavy(heavy)
    assert proposal.reason.startswith("the fewest in which no command waits for something heavy")


def test_one_bridge_suffices_for_what_is_light(system):
    assert len(propose(system(STATION), Assumptions(), None).parts) == 1


def test_what_is_too_much_for_one_bridge_is_spread(system):
    rates = dict.fromkeys(("velocity", "speed", "costs", "effort"), 4000.0)
    proposal = propose(system(STATION), Assumptions(rates=rates, lengths={"costs": 10}), None)
    assert len(proposal.parts) > 1
    for part in proposal.parts:
        assert part.share <= LARGEST_SHARE or len(part.groups) == 1


def test_each_part_has_what_its_connections_need(system):
    whole = system(STATION)
    first, second = split(propose(whole, GRIDS, None), whole)
    assert list(whole.bridges) == [first, second]
    assert (first.name, first.address) == ("station", "10.1.2")
    assert (second.name, second.address) == ("station_2", "10.1.3")
    assert (second.authority, second.namespace) == (7, "desk")
    assert [each.name for each in first.provides] == []
    assert [each.name for each in second.provides] == ["CostMap2D"]
    assert [each.name for each in second.uses] == []
    assert [each.name for each in first.quantities] == ["max_speed"]
    assert list(second.quantities) == []


def test_others_follow_to_the_part_that_answers(system):
    whole = system(STATION)
    _, second = split(propose(whole, GRIDS, None), whole)
    (wanted,) = whole.components[1].connections
    assert wanted.provider is second


def test_joined_reports_follow_to_the_part_that_sends_them(system):
    """The main report comes from a component, the joined one from the bridge that is split."""
    text = STATION.replace("provides: CostMap2D", "provides: CostMap2D, VelocityStateSensor")
    text = text.replace("map: velocity_state ", "map: velocity_state  direction: jausToRos ")
    text = text.replace(
        "    connection costs {",
        "    connection told { map: velocity_state  direction: rosToJaus  topic told }\n"
        "    connection costs {",
    )
    text += """
bridge watcher {
    address: 10.1.20
    uses: LocalPoseSensor, VelocityStateSensor
    connection seen {
        map: odometry  peers: vehicle  rate: 20  topic seen
        sources: { join: velocity  peers: station  rate: 20 }
    }
}
"""
    whole = system(text, head=HEAD + "import mappings.odometry\n")
    often = Assumptions(rates={"told": 900.0})
    made = split(propose(whole, often, 4), whole)
    (wanted,) = (each for each in whole.bridges if each.name == "watcher")
    (peer,) = wanted.bridgeConnections[0].sources[0].peers
    assert "told" in [each.name for each in peer.bridgeConnections]
    assert peer in made[1:]


def test_each_part_guards_itself_as_the_whole_did(system):
    hosts = 'allowedHosts: "10.0.0.0/24", "10.0.1.7"\n    fixedSources: true\n    '
    whole = system(STATION.replace("authority: 7", hosts + "authority: 7"))
    for part in split(propose(whole, Assumptions(), 3), whole):
        assert part.fixedSources
        assert list(part.allowedHosts) == ["10.0.0.0/24", "10.0.1.7"]


def test_private_topics_keep_their_full_names(system):
    whole = system(STATION)
    made = split(propose(whole, Assumptions(), 3), whole)
    topics = {each.name: each.topics[0].name for owner in made for each in owner.bridgeConnections}
    moved = {each.name for owner in made[1:] for each in owner.bridgeConnections}
    assert topics["velocity"] == ("/desk/station/odom" if "velocity" in moved else "~/odom")
    assert "velocity" in moved or "effort" in moved


def test_calls_of_ros_services_stay_with_whom_they_ask(system):
    text = STATION.replace(
        "    connection effort",
        """    bridge.ros_service_connection stop {
        direction: rosToJaus  service: stop  type: std_srvs/Trigger  control: false
        message: QueryStatus  answer: ReportStatus  successMember: success  peers: vehicle
    }
    connection effort""",
    )
    whole = system(text.replace("uses: PrimitiveDriver", "uses: Management, PrimitiveDriver"))
    proposal = propose(whole, GRIDS, 2)
    first, second = split(proposal, whole)
    assert [each.name for each in first.serviceConnections] == ["stop"]
    assert {"effort", "speed"} <= {each.name for each in first.bridgeConnections}
    assert [each.name for each in second.bridgeConnections] == ["costs"]
    assert "Management" in [each.name for each in first.uses]


def test_who_is_commanded_keeps_name_and_address(system):
    whole = system(
        VEHICLE
        + """
bridge robot {
    address: 10.1.2
    uses: VelocityStateSensor
    provides: VelocityStateDriver
    connection seen { map: velocity_state  peers: vehicle  rate: 90  topic odom }
    connection drive { map: velocity_command  topic cmd_vel }
}
component operator { address: 10.1.7  controls: robot  uses: VelocityStateDriver }
"""
    )
    first, second = split(propose(whole, Assumptions(), 2), whole)
    assert [each.name for each in first.bridgeConnections] == ["drive"]
    assert (first.name, second.name) == ("robot", "robot_2")
    assert list(whole.components[1].controls) == [first]


PUBLISHER = """
host car {{ interface: `10.0.0.1` }}
host desk {{ interface: `10.0.0.2` }}
node mapper {{ publisher grid {{ topic: /desk/grid  type: nav_msgs/OccupancyGrid }} }}
placement {{ host: car  components: vehicle, viewer }}
placement {{ host: desk  components: station }}
placement {{ host: {mapper}  nodes: mapper }}
"""


def test_a_part_goes_to_the_host_of_its_nodes(system):
    hosts = PUBLISHER.format(mapper="car")
    whole = system(STATION + hosts)
    made = split(propose(whole, GRIDS, None), whole)
    assert [host_of(whole, each).name for each in made] == ["desk", "car"]
    hosts = hosts.replace("car  nodes: mapper", "desk  nodes: mapper").replace(", viewer", "")
    whole = system(STATION + hosts.replace("components: station", "components: station, viewer"))
    made = split(propose(whole, GRIDS, None), whole)
    assert [host_of(whole, each).name for each in made] == ["desk", "desk"]


def test_no_more_bridges_than_groups(system):
    with pytest.raises(UnsplittableError, match="no more than 3 bridges are possible, 4 were"):
        propose(system(STATION), Assumptions(), 4)


def test_bridges_are_not_merged(system):
    text = STATION + "bridge other { address: 10.1.5  uses: VelocityStateSensor\n"
    text += "connection seen { map: velocity_state  peers: vehicle  topic other } }"
    with pytest.raises(UnsplittableError, match="bridges are not merged: name 2 or more"):
        propose(system(text), Assumptions(), 1)
    assert len(propose(system(text), Assumptions(), 3).parts) == 3


def test_a_full_node_has_no_room(system):
    text = STATION + "".join(
        f"component c{n} {{ address: 10.1.{n} }}\n" for n in range(3, 255) if n != 9
    )
    whole = system(text)
    with pytest.raises(AddressesExhaustedError, match=r"node 10\.1 has no free component id"):
        split(propose(whole, GRIDS, None), whole)


def test_the_text_says_why(system):
    whole = system(STATION)
    proposal = propose(whole, GRIDS, None)
    text = render(proposal, split(proposal, whole))
    assert "bridge station_2 (10.1.3), split off station" in text
    assert "here: heavy, apart from commands that do not belong to it" in text
    assert max(map(len, text.splitlines())) <= 100


def test_a_bridge_gives_each_reason_once(system):
    whole = system(STATION)
    proposal = propose(whole, Assumptions(), None)
    lines = render(proposal, split(proposal, whole)).splitlines()
    assert len(names(proposal)[0]) > 2
    reasons = [line for line in lines if "here: " in line]
    assert len(reasons) == len(set(reasons)) == 2
