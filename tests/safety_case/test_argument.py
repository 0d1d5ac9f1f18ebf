"""The argument of a safety case: what answers a hazard, what does not, and what evidence says."""

import re
from pathlib import Path

import pytest
from sweeps import sweep

from jausml.language.validation.engine import check_project
from jausml.safety_case.argument import safety_case
from jausml.safety_case.evidence import Evidence, generated_tests, read_evidence
from jausml.safety_case.hazards import HAZARDS

GUARDS = ("jausml/safety_case", "metamodels")

MODELS = Path(__file__).resolve().parents[2] / "models"
MOWER = Path(__file__).with_name("mower.ros2jaus")
CAR = MODELS / "catvehicle" / "catvehicle.xmi"
WINCH = MODELS / "examples" / "winch" / "winch.xmi"
WAYPOINTS = MODELS / "examples" / "waypoints" / "waypoints.ros2jaus"
LIBRARY = "http://www.jausml.org/library/"


def goals(path, *evidence, tests=()):
    """Returns the goals of a model by their ids."""
    report = check_project([str(path)], is_one=True)
    return {goal.id: goal for goal in safety_case(report, evidence, tests).goals}


def changed(path, folder, old, new):
    """Returns a copy of a model in which a text stands in the place of another one."""
    for file in path.parent.glob(f"*{path.suffix}"):
        text = re.sub(r"(\.\./)+library/", LIBRARY, file.read_text(encoding="utf-8"))
        assert file != path or old in text
        text = text.replace(old, new) if file == path else text
        (folder / file.name).write_text(text, encoding="utf-8")
    return folder / path.name


@pytest.fixture(scope="module")
def mower():
    """The goals of a model that answers each hazard."""
    return goals(MOWER)


def test_a_model_may_answer_each_hazard(mower):
    assert {goal_name.partition("/")[0] for goal_name in mower} == {hazard.id for hazard in HAZARDS}
    assert [goal.claim for goal in mower.values() if not goal.answered] == []


SAFE_VALUE = '<safeValue target="twist.linear.x" value="0.0"/>'
KEEP = ("map: local_pose", "map: local_pose whenStale: keep")
REMOVED = [
    ("link/mower.spin", "controlTimeout: 2", "controlTimeout: 0"),
    ("link/blade", "controlTimeout: 2", "controlTimeout: 0"),
    ("operator/mower.spin", "silenceTimeout: 0.6", "silenceTimeout: 0"),
    ("operator/blade", "controlTimeout: 2", "controlTimeout: 0"),
    ("sensor/mower.pose", *KEEP),
    ("sensor/mower.spinning", "deadline: 0.5", "deadline: 0"),
    ("sensor/operator.pose", "silenceTimeout: 2", ""),
    ("stale/mower.drive", "ageLimit: 0.5", ""),
    ("stale/mower.spin", "ageLimit: 0.6", ""),
    ("stale/mower.pose", *KEEP),
    ("unit/mower.spin", "vector half ROS->JAUS ( data = 0.5 => PropulsiveLinearEffortX = 50 )", ""),
    ("preemption/mower.drive", "map: velocity_command", "map: velocity_command onSilence: hold"),
    ("preemption/mower.spin", "silenceTimeout: 0.6", "silenceTimeout: 0.6 control: false"),
    ("foreign/mower.drive", "peers: operator", ""),
    ("crash/mower.drive", "controlTimeout: 3", "controlTimeout: 3 guardian: false"),
    ("crash/mower.spin", "safeValue: { target: PropulsiveLinearEffortX  value: 0 }", ""),
    ("overload/mower.drive", "rateCap: 100", ""),
    ("overload/mower", 'allowedHosts: "10.0.0.0/24"', ""),
]


@pytest.mark.parametrize(("goal", "old", "new"), REMOVED, ids=[removal[0] for removal in REMOVED])
def test_without_its_answer_a_goal_is_undeveloped(mower, tmp_path, goal, old, new):
    model = changed(MOWER, tmp_path, old, new)
    if goal == "foreign/mower.drive":  # either is enough
        model = changed(model, tmp_path, 'allowedHosts: "10.0.0.0/24"', "")
    found = goals(model)
    assert mower[goal].answered
    assert not found[goal].answered
    assert found[goal].gaps


@pytest.mark.parametrize(
    ("model", "goal", "old", "new"),
    sweep(
        [
            (CAR, "operator/bridge.speed_command", 'silenceTimeout="0.5"', 'silenceTimeout="0"'),
            (CAR, "preemption/bridge.cruise_speed", SAFE_VALUE, ""),
            (CAR, "crash/bridge.cruise_speed", ' controlTimeout="2"', ' guardian="false"'),
            (CAR, "foreign/bridge.cruise_speed", 'peers="operator_control_unit"', ""),
            (CAR, "stale/bridge.estimated_pose", 'freshness="1.0"', ""),
            (WINCH, "link/winch", 'controlTimeout="2"', 'controlTimeout="0"'),
            (WINCH, "sensor/winch_operator.winch_state", 'silenceTimeout="1.0"', ""),
            (
                WAYPOINTS,
                "link/waypoint_vehicle.travel_speed",
                "controlTimeout: 5",
                "controlTimeout: 0",
            ),
            (WAYPOINTS, "operator/waypoint_vehicle.global_waypoint", "onSilence: hold", ""),
            (WAYPOINTS, "crash/waypoint_vehicle.travel_speed", "frequency: 10", "guardian: false"),
        ],
        every=3,
    ),
)
def test_answers_of_the_examples_can_be_lost(tmp_path, model, goal, old, new):
    assert goals(model)[goal].answered
    assert not goals(changed(model, tmp_path, old, new))[goal].answered


def test_what_others_make_is_no_goal(tmp_path, mower):
    own = "provides: PrimitiveDriver, Management"
    found = goals(changed(MOWER, tmp_path, own, f"external: true {own}"))
    assert mower.keys() - found.keys() == {"link/blade", "operator/blade", "foreign/blade"}
    (answer,) = found["link/mower.spin"].answers
    assert answer.text.endswith("(external: if they do what the model says)")


def test_each_number_needs_something_that_says_what_is_right(tmp_path):
    goal, more = "unit/mower.spin", "data -> ResistiveLinearEffortX : scale(50)"
    two = changed(MOWER, tmp_path, ": scale(100) )", f": scale(100)\n {more} )")
    (gap,) = goals(two)[goal].gaps
    assert gap.startswith("nothing says what is right of ResistiveLinearEffortX (")
    expected = "PropulsiveLinearEffortX = 50"
    shown = changed(two, tmp_path, expected, f"{expected} ResistiveLinearEffortX = 25")
    assert goals(shown)[goal].answered


def test_silence_and_control_both_stop_a_lost_operator(tmp_path):
    goal = "operator/mower.drive"
    never = 'silenceTimeout: 0 holdReason: "it has a dead man\'s switch"'
    without = changed(MOWER, tmp_path, "silenceTimeout: 0.5", never)
    assert goals(without)[goal].answered
    neither = changed(without, tmp_path, "controlTimeout: 3", "controlTimeout: 0")
    assert not goals(neither)[goal].answered


def test_a_finding_of_a_rule_speaks_against_a_goal(tmp_path):
    end = 'source="Velocity_Y" whenAbsent="useDefault" defaultValue="0">'
    found = goals(changed(CAR, tmp_path, f"{end}\n        <conversions/>", end))[
        "unit/bridge.odometry"
    ]
    assert not found.answered
    (against,) = (support for support in found.supports if not support.holds)
    assert against.text.startswith("JML433 ")


def test_a_hold_needs_the_reason_of_a_person(tmp_path):
    goal = "operator/bridge.steering_command"
    (answer,) = goals(CAR)[goal].answers
    assert answer.reason == "the wheels stay as they are while speed_command stops the vehicle"
    assert goals(CAR)[goal].lacks == ("model check",)
    found = goals(changed(CAR, tmp_path, answer.reason, "todo"))[goal]
    assert found.answers == ()
    assert found.gaps == ("nothing stops it, and nobody says why its last command may stand",)


def test_an_open_decision_leaves_its_goals_undeveloped(tmp_path):
    question = 'openDecisions: { text: "is half a second enough?"  blocking: false }'
    found = goals(changed(MOWER, tmp_path, "rateCap: 100", f"rateCap: 100 {question}"))
    of_drive = [goal for name, goal in found.items() if name.endswith("/mower.drive")]
    assert len(of_drive) == len(HAZARDS) - 1  # it is no sensor
    assert {goal.gaps for goal in of_drive} == {("open decision: is half a second enough?",)}


def test_what_the_examples_leave_open():
    def undeveloped(path):
        return sorted(name for name, goal in goals(path).items() if not goal.answered)

    assert undeveloped(WINCH) == []
    assert {goal_name.partition("/")[0] for goal_name in undeveloped(WAYPOINTS)} == {
        *("sensor", "stale", "foreign", "overload")
    }
    assert [
        goal_name for goal_name in undeveloped(CAR) if goal_name.startswith(("sensor", "unit"))
    ] == [
        "sensor/bridge.odometry",
        "sensor/bridge.pose",
        "sensor/bridge.steering_angle",
        "sensor/operator_control_unit.estimated_pose",
        "unit/bridge.speed_command",
    ]


def test_only_evidence_that_ran_supports_a_goal():
    report = check_project([str(MOWER)], is_one=True)
    goal = "link/blade"
    product = {"name": "blade: ReceiveFSM", "complete": True, "found": []}
    checked = Evidence("E1", "model check", content={"products": [product]})
    silent, shown = (safety_case(report, evidence_set, ()) for evidence_set in ((), (checked,)))
    assert silent.summary == (
        "0 of 25 goals supported by evidence that ran; 25 held by rules alone"
    )
    assert [shown_goal.id for shown_goal in shown.goals if shown_goal.supported] == [
        goal,
        "operator/blade",
        "foreign/blade",
    ]
    assert all(shown_goal.answered for shown_goal in shown.goals)


def test_the_word_of_a_person_is_told_apart_from_evidence():
    goal = "operator/bridge.steering_command"
    product = {"name": "bridge.steering_command to vehicle", "complete": True, "found": []}
    found = goals(CAR, Evidence("E1", "model check", content={"products": [product]}))[goal]
    assert any(support.evidence == "E1" and support.holds for support in found.supports)
    assert found.standing == "held by the word of a person"
    assert not found.supported


def test_a_rate_is_no_time():
    answers = goals(MOWER)["overload/mower.drive"].answers
    assert [(answer.text, answer.seconds) for answer in answers] == [
        ("takes 100 messages/s of one source at most", 0.0)
    ]


def test_a_stop_is_told_with_what_it_sends():
    answers = goals(MOWER)["operator/mower.spin"].answers
    assert any("sends its stop (PropulsiveLinearEffortX = 0)" in answer.text for answer in answers)


def test_what_a_stop_sends_may_have_braces(tmp_path):
    own = 'PropulsiveLinearEffortX  value: "{effort}"'
    answers = goals(changed(MOWER, tmp_path, "PropulsiveLinearEffortX  value: 0", own))
    (silence, *_) = answers["operator/mower.spin"].answers
    assert silence.text == (
        "sends its stop (PropulsiveLinearEffortX = {effort}) after 0.6 s of silence"
    )


def says(goal, kind, content, *, tests=()):
    """Returns what a piece of evidence says of a goal of the car, and what that still lacks."""
    found = goals(CAR, Evidence("E1", kind, content=content), tests=tests)[goal]
    return [(e.holds, e.text) for e in found.supports if e.evidence == "E1"], found.lacks


def test_a_proof_is_of_the_map():
    def proof(*found):
        totals = (65536, 1 << 32, 1 << 32)
        fields = [{"tried": 65536, "total": total} for total in totals]
        return {"maps": [{"name": "cruise_speed", "fields": fields, "found": list(found)}]}

    said, lacks = says("unit/bridge.cruise_speed", "proof", proof())
    assert said == [
        (True, "map cruise_speed: 3 numbers, 1 of them whole, 196,608 values, no findings")
    ]
    assert "proof" not in lacks
    said, lacks = says("unit/bridge.cruise_speed", "proof", proof("JML922 Velocity_X drifts"))
    assert said == [(False, "map cruise_speed: JML922 Velocity_X drifts")]
    assert "proof" in lacks
    assert says("unit/bridge.odometry", "proof", proof())[0] == []
    without = {"maps": [{"name": "cruise_speed", "fields": [], "found": []}]}
    assert says("unit/bridge.cruise_speed", "proof", without)[0] == []


def test_a_product_check_is_of_the_connection_and_its_rules():
    def checked(*rules, complete=True, allowed=()):
        found = [{"rule": rule, "message": "is wrong"} for rule in rules]
        product = {"name": "bridge.cruise_speed", "complete": complete, "found": found}
        product["allowed"] = [{"rule": rule, "reason": "it is known"} for rule in allowed]
        return {"products": [product]}

    goal = "operator/bridge.cruise_speed"
    assert says(goal, "model check", checked("JML934"))[0] == [
        (True, "bridge.cruise_speed: JML933 hold in all states")
    ]
    assert says(goal, "model check", checked("JML933"))[0] == [
        (False, "bridge.cruise_speed: JML933 is wrong")
    ]
    assert says(goal, "model check", checked(complete=False))[0] == []
    # What a person allows was found, and shows nothing.
    assert says(goal, "model check", checked(allowed=["JML933"]))[0] == []
    assert says(goal, "model check", checked(allowed=["JML934"]))[0][0][0]


def test_fault_runs_are_held_against_the_time_of_the_model():
    def runs(seconds):
        return {"faults": {"operator killed": {"stopped": {"cruise_speed": seconds}}}}

    goal = "operator/bridge.cruise_speed"
    assert says(goal, "fault runs", runs(2.2))[0] == [
        (True, "1 runs; slowest stop after 2.20 s (operator killed)")
    ]
    ((holds, text),), lacks = says(goal, "fault runs", runs(9.0))
    assert not holds
    assert text.endswith("the model says 2 s")
    assert "fault runs" in lacks
    assert says("preemption/bridge.cruise_speed", "fault runs", runs(2.2))[0] == []


def test_a_mutation_that_nothing_notices_speaks_against_a_goal():
    def outcome(verdict, place="safeValue[0]"):
        place = f"catvehicle/bridge/cruise_speed/{place}"
        return {"outcomes": [{"place": place, "change": "0 to 1", "verdict": verdict}]}

    goal = "operator/bridge.cruise_speed"
    assert says(goal, "mutations", outcome("nothing"))[0] == [
        (False, "nothing notices: 0 to 1 (for no known reason)")
    ]
    noticed = [(True, "1 mutations, all noticed or of no effect")]
    assert says(goal, "mutations", outcome("tests"))[0] == noticed
    assert says(goal, "mutations", outcome("equal"))[0] == noticed
    assert says("unit/bridge.odometry", "mutations", outcome("tests"))[0] == []
    factor = outcome("nothing", "toRos[2]")
    assert says(goal, "mutations", factor)[0] == []  # the map has the name of the connection
    assert says("unit/bridge.cruise_speed", "mutations", factor)[0][0][0] is False


def test_stale_evidence_says_nothing():
    fields = [{"tried": 256, "total": 256}]
    content = {"maps": [{"name": "cruise_speed", "fields": fields, "found": []}]}
    stale = Evidence("E1", "proof", stale="is of another version of the model", content=content)
    found = goals(CAR, stale)["unit/bridge.cruise_speed"]
    assert [support.evidence for support in found.supports] == ["E0"]
    assert "proof" in found.lacks


def test_a_test_run_has_to_run_what_is_generated():
    report = check_project([str(CAR)], is_one=True)
    tests = generated_tests(report.model)
    name, module = "test_cruise_speed_safe_value", Path(tests[0].path).stem
    assert "_safe_value" in tests[0].names["cruise_speed"]
    goal = "operator/bridge.cruise_speed"

    def ran(outcome):
        return {"tests": {f"{module}.{name}": outcome} if outcome else {"other.test": "passed"}}

    said, lacks = says(goal, "test run", ran("passed"), tests=tests)
    assert said == [(True, f"{name} of {module} passed")]
    assert "test run" not in lacks
    for bad in ("failure", "error"):
        assert says(goal, "test run", ran(bad), tests=tests)[0] == [(False, f"{name} failed")]
    for missing in ("", "skipped"):
        said, lacks = says(goal, "test run", ran(missing), tests=tests)
        assert said == []
        assert "test run" in lacks


def test_of_several_runs_of_a_test_the_worst_counts(tmp_path):
    case = '<testcase classname="test_m" name="test_a[{}]">{}</testcase>'
    outcomes = ("", "<skipped/>", "<failure/>", "<skipped/>", "")
    cases = "".join(case.format(*pair) for pair in enumerate(outcomes))
    report = tmp_path / "run.xml"
    report.write_text(f"<testsuite>{cases}</testsuite>", encoding="utf-8")
    evidence = read_evidence(report, "run.xml", 1, ())
    assert evidence.content == {"tests": {"test_m.test_a": "failure"}}
