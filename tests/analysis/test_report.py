"""Reports: loads, budgets and warnings of systems, against figures that were worked out by hand."""

import pytest
from efforts import EFFORTS

from jausml.views.analysis.report import report_of
from jausml.views.analysis.sizes import Assumptions

PAIR = """
bridge vehicle {
    address: 10.1.1
    controlTimeout: 4
    provides: VelocityStateSensor, VelocityStateDriver
    connection velocity { map: velocity_state  topic odom { qos: { depth: 5 } } }
    connection drive { map: velocity_command  silenceTimeout: 0.6  topic cmd_vel }
}

bridge station {
    address: 10.1.2
    uses: VelocityStateSensor, VelocityStateDriver
    provides: Management
    connection seen { map: velocity_state  peers: vehicle  rate: RATE  topic odom_seen  topic copy }
    connection wanted { map: velocity_command  peers: vehicle  acknowledge: ACK  topic stick }
}
"""


def pair(system, rate="25", acknowledge="false", **assumptions):
    text = PAIR.replace("RATE", rate).replace("ACK", acknowledge)
    report = report_of(system(text), Assumptions(**assumptions))
    found = {
        f"{owner.name}.{connection.name}": connection
        for owner in report.bridges
        for connection in owner.connections
    }
    return report, found


def test_both_ends_see_one_stream(system):
    _, found = pair(system)
    assert found["station.seen"].flows == found["vehicle.velocity"].flows
    assert found["station.wanted"].flows == found["vehicle.drive"].flows
    (event,) = found["station.seen"].flows
    assert (event.sender, event.receiver, event.kind) == ("vehicle", "station", "event")
    assert (event.hertz, event.basis) == (25, "declared")
    (command,) = found["vehicle.drive"].flows
    assert (command.hertz, command.basis) == (10, "assumed")


def test_a_rate_beside_every_change_is_served_by_queries(system):
    changes = "map: velocity_state  peers: vehicle  exchange: everyChangeEvent  topic changed"
    text = PAIR.replace("RATE", "25").replace("ACK", "false")
    text = text.replace(
        "connection seen", f"connection changed {{ {changes} }}\n    connection seen"
    )
    report = report_of(system(text), Assumptions())
    (station,) = (bridge for bridge in report.bridges if bridge.name == "station")
    kinds = {
        connection.name: [flow.kind for flow in connection.flows]
        for connection in station.connections
    }
    assert kinds["changed"] == ["event"]
    assert sorted(kinds["seen"]) == ["query", "report"]


def test_what_one_end_sends_the_other_receives(system):
    _, found = pair(system)
    seen, velocity = found["station.seen"].load, found["vehicle.velocity"].load
    assert seen.received == velocity.sent
    (event,) = found["station.seen"].flows
    assert seen.received.packets == 25
    assert seen.received.judp == 25 * event.datagram_bytes
    assert seen.received.ip == 25 * (event.datagram_bytes + 28)


def test_fan_out_counts_topics_and_peers(system):
    _, found = pair(system)
    assert found["station.seen"].fan_out == 2
    assert found["station.seen"].ros.messages_per_s == 50
    assert found["station.wanted"].fan_out == 1


def test_acknowledgements_go_back(system):
    _, found = pair(system, acknowledge="true")
    load = found["station.wanted"].load
    assert (load.sent.packets, load.received.packets) == (10, 10)
    assert load.received.judp == 10 * 15


def test_assumptions_are_of_all_or_of_one(system):
    _, found = pair(system, rate="25", rates={"station.wanted": 50.0})
    assert found["station.wanted"].flows[0].hertz == 50
    _, found = pair(system, rate="25")
    assert found["station.wanted"].flows[0].hertz == 10


def test_upkeep_is_in_the_sums(system):
    report, _ = pair(system)
    station = next(component for component in report.components if component.name == "station")
    # Control of the vehicle is renewed each second, a quarter of its 4 seconds: a request that is
    # acknowledged, and a query; two answers. Its event is renewed twice a minute.
    assert station.upkeep.messages_sent == pytest.approx(2 + 1 / 30)
    assert station.upkeep.messages_received == pytest.approx(2 + 1 / 30)


def test_a_rate_that_the_provider_does_not_give(system):
    _, found = pair(system, rate="400")
    assert found["station.seen"].flows[0].hertz == 400
    assert not any("vehicle gives" in warning for warning in found["station.seen"].warnings)
    _, found = pair(system, rate="0.05")
    assert "vehicle gives 0.1 Hz at least, 0.05 Hz are asked" in found["station.seen"].warnings


def test_a_silence_time_out_must_hold_two_periods(system):
    _, found = pair(system)
    assert found["vehicle.drive"].warnings == ()
    _, found = pair(system, rate="25", rates={"wanted": 2.0})
    assert found["vehicle.drive"].warnings == (
        "silence time-out of 0.6 s is shorter than 2 times the assumed period of 0.5 s",
    )


def test_the_slowest_of_several_senders_says_what_a_time_must_hold(system):
    text = PAIR.replace("RATE", "25").replace("ACK", "false")
    other = text[text.index("bridge station") :].replace("station", "other").replace("1.2", "1.3")
    rates = {"station.wanted": 50.0, "other.wanted": 2.0}
    report = report_of(system(text + other), Assumptions(rates=rates))
    (drive,) = (e for owner in report.bridges for e in owner.connections if e.name == "drive")
    assert drive.warnings == (
        "silence time-out of 0.6 s is shorter than 2 times the assumed period of 0.5 s",
    )
    assert budgets(drive)["one_lost_packet"].seconds == pytest.approx(0.5)


def test_a_freshness_must_hold_a_period(system):
    _, found = pair(system, rate="25", rates={"velocity": 0.5})
    (warning,) = found["vehicle.velocity"].warnings
    assert warning == "freshness of 1 s is shorter than the assumed period of 2 s"


def budgets(connection):
    return {budget.case: budget for budget in connection.budgets}


def test_budgets_of_a_command(system):
    _, found = pair(system)
    wanted = budgets(found["station.wanted"])
    assert wanted["normal"].seconds == 0
    assert wanted["one_lost_packet"].seconds == pytest.approx(0.1)  # the next message
    assert wanted["queue_full"].seconds == 2  # what is older is dropped
    # 1 second of silence, and the stop repeated three times, a tenth of a second apart.
    assert wanted["source_dead"].seconds == pytest.approx(1.0 + 0.3)
    assert wanted["controller_dead"].seconds == 4
    drive = budgets(found["vehicle.drive"])
    assert drive["source_dead"].seconds == pytest.approx(0.6)
    assert drive["controller_dead"].seconds == 4


def test_a_command_that_is_acknowledged_is_repeated(system):
    _, found = pair(system, acknowledge="true")
    (step,) = budgets(found["station.wanted"])["one_lost_packet"].steps
    assert (step.name, step.seconds) == ("repetition of the packet", 0.1)


@pytest.mark.parametrize(
    ("qos", "depth"),
    [
        ("depth: 5", 100),
        ("depth: 120", 120),
        ("durability: transient_local  depth: 1", 1),
        ("durability: transient_local  depth: 120", 120),
    ],
)
def test_a_queue_of_a_volatile_topic_has_a_least_depth(system, qos, depth):
    text = PAIR.replace("RATE", "25").replace("ACK", "false")
    text = text.replace("topic stick", f"topic stick {{ qos: {{ {qos} }} }}")
    report = report_of(system(text), Assumptions())
    (wanted,) = (
        connection
        for owner in report.bridges
        for connection in owner.connections
        if connection.name == "wanted"
    )
    queue = budgets(wanted)["queue_full"].steps[-1]
    assert queue.name.replace(",", "").split()[:3] == ["queue", "of", str(depth)]
    assert queue.seconds == min(depth / 10, 2)


def test_budgets_of_a_report(system):
    _, found = pair(system, rate="20", rates={"velocity": 200.0})
    velocity = budgets(found["vehicle.velocity"])
    assert velocity["normal"].seconds == pytest.approx(0.05)
    assert velocity["queue_full"].seconds == pytest.approx(0.05 + 100 / 200)
    assert velocity["one_lost_packet"].seconds == pytest.approx(0.1)
    assert velocity["source_dead"].seconds == pytest.approx(1.0 + 0.05)


def test_no_bound_has_a_reason(system):
    _, found = pair(system)
    dead = budgets(found["station.seen"])["source_dead"]
    assert dead.seconds is None
    assert dead.never == "nothing is published any more, and no safe value is stated"


MAP = """
bridge mapper {
    address: 10.1.1
    provides: CostMap2D
    connection costs { map: cost_map  direction: rosToJaus  exchange: EXCHANGE  topic grid }
}
"""


def test_large_messages_are_cut_and_acknowledged(system):
    text = MAP.replace("EXCHANGE", "everyChangeEvent")
    report = report_of(system(text), Assumptions(length=160_000, rate=2.0))
    (costs,) = report.bridges[0].connections
    (event,) = costs.flows
    assert event.size.most == event.size.expected == 131_102  # its count has 16 bits
    assert event.packets == -(-event.size.expected // 4079)
    assert event.is_acknowledged
    assert costs.load.received.packets == 2 * event.packets
    assert costs.load.sent.packets == 2 * event.packets


WHOLE = f"""
effort {{
  JAUS SetWrenchEffort
  ROS Effort ( {"  ".join(f"float64 {name}" for name in EFFORTS)} )
  ROS->JAUS ( . -> . )
}}
component vehicle {{ address: 1.1.1 provides: PrimitiveDriver }}
bridge front {{
    address: 1.1.2  uses: PrimitiveDriver
    connection drive {{
      map: effort  direction: rosToJaus  peers: vehicle
      onSilence: hold  holdReason: "the rig stands on blocks"  topic stick
    }}
}}
"""


def test_a_message_has_the_fields_of_a_whole_that_goes_onto_it(system):
    (drive,) = report_of(system(WHOLE), Assumptions()).bridges[0].connections
    (command,) = drive.flows
    # Its code and presence vector, and fields of which the resistive ones have 8 bits.
    assert command.size.most == 2 + 2 + 6 * 2 + 6 * 1


def test_who_is_not_modelled_asks_once(system):
    report = report_of(system(MAP.replace("EXCHANGE", "query")), Assumptions())
    (costs,) = report.bridges[0].connections
    pairs = [(flow.kind, flow.sender) for flow in costs.flows]
    assert pairs == [("query", "anybody"), ("report", "mapper")]
    assert costs.peers == ("anybody",)


def test_a_host_sums_what_runs_there(system):
    report, _ = pair(system)
    assert report.hosts == ()


def test_what_is_shaped_costs_less_and_waits_longer(system):
    plain = report_of(system(PAIR.replace("RATE", "25").replace("ACK", "false")), Assumptions())
    text = PAIR.replace("RATE", "25  maxRate: 5").replace("ACK", "false  decimation: 2  maxRate: 4")
    shaped = report_of(system(text), Assumptions())

    def of(report, owner, name):
        (bridge,) = [candidate for candidate in report.bridges if candidate.name == owner]
        (found,) = [connection for connection in bridge.connections if connection.name == name]
        return found

    sent = of(shaped, "station", "wanted")
    assert [flow.hertz for flow in sent.flows] == [4]
    assert sent.ros.messages_per_s == 10
    steps = {step.name: step.seconds for step in sent.budgets[0].steps}
    assert steps == {"decimation, one of 2 messages": 0.1, "maxRate of 4 Hz": 0.25}
    seen = of(shaped, "station", "seen")
    assert [flow.hertz for flow in seen.flows] == [25]
    assert seen.ros.messages_per_s == 10  # two topics
    assert seen.share < of(plain, "station", "seen").share
    assert sent.share < of(plain, "station", "wanted").share


def test_services_and_actions_are_told_beside_the_connections(live_system):
    report = report_of(live_system("waypoint_lists.ros2jaus"), Assumptions())
    robot, station, tracker, spooler, dispatcher = report.bridges
    (follow,), (through,), (path,) = robot.calls, station.calls, tracker.calls
    (missions,), (goals,) = spooler.calls, dispatcher.calls
    assert (missions.direction, goals.direction) == ("jausToRos", "rosToJaus")
    assert goals.peers == ("spooler",)
    assert (follow.kind, follow.direction, follow.peers) == ("action", "jausToRos", ())
    assert (through.ros_name, through.type) == ("navigate_through_poses", "NavigateThroughPoses")
    assert through.messages[0] == "SetLocalWaypoint"
    assert (through.peers, through.seconds) == (("robot",), 1.0)
    assert (path.ros_name, path.direction) == ("follow_path", "jausToRos")
    others = report_of(live_system("services.ros2jaus"), Assumptions()).bridges
    served = [call for other in others for call in other.calls]
    assert {call_report.kind for call_report in served} == {"service"}
    assert all(call_report.messages and call_report.seconds > 0 for call_report in served)
