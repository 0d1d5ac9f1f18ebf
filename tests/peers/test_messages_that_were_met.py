"""What three new users were told when something was wrong, and that it says what to do next.

Each row is one message that they met: the files and commands before it, the command that goes
wrong, and what it must say in order, the last part being the next step.
"""

import shlex
from dataclasses import dataclass, field

import pytest
from click.testing import CliRunner

from jausml.cli import main
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.bridge.connections.reporting import FEWEST_FAILURES, Reporting
from jausml.runtime.bridge.messages.limits import AbsentFieldError
from jausml.runtime.messages import RequestControl

pytestmark = pytest.mark.ports

PACKAGE = """<package format="3"><name>abyss_msgs</name><version>1.0.0</version>
<description>Tanks.</description><maintainer email="x@example.org">x</maintainer>
<license>MIT</license></package>
"""
TANK = "float32 level # [%]\n"
SPEED = """import `jaus.core-1.1`
import jaus.mobility
service_set farm { service Speeds {
    urn: "urn:example:Speeds"  inherits: Management
    inputs: new message_def QuerySpeed { code: 0xD102 }
    outputs: new message_def ReportSpeed { code: 0xD101 record R {
        fixed_field Fast { type: uint8 }  fixed_field Slow { type: uint8 }
    } }
} }
drive { JAUS SetVelocityCommand  ROS geometry_msgs/Twist  JAUS->ROS ( Velocity_X -> linear.x ) }
speeds { JAUS ReportSpeed  ROS std_msgs/UInt8  ROS->JAUS ( data -> Fast ) }
system s { bridge b {
    address: 1.1.1  provides: Speeds, VelocityStateDriver
    connection c { map: speeds  topic c }
    connection d { map: drive  topic d }
} }
"""
UNIT = 'Fast { type: uint16  units: "hectare"  scale: { lower: 0  upper: 9 } }'
DRIVE = "bridge b { address: 100.1.1 connection c { map: velocity_command topic cmd_vel } }\n"
JSIDL = """<service_def xmlns="urn:jaus:jsidl:1.0" name="Boom" id="urn:agro:Boom" version="1.0">
<message_set><input_set/><output_set><message_def name="M" message_id="D103" is_command="false">
<body name="B"><presence_vector field_type_unsigned="unsigned byte"/></body>
</message_def></output_set></message_set></service_def>
"""
MODES = """import `jaus.core-1.1`
service_set own { service Modes {
    urn: "urn:example:Modes"  inherits: Management
    inputs: new message_def SetMode { code: 0xD101  isCommand: true  record ModeRec {
        fixed_field Mode {
            values: { enumerated_value hold { value: 0 } enumerated_value go { value: 1 } }
        }
    } }
} }
"""
TANKS = """import `jaus.core-1.1`
service_set own { service Tanks {
    urn: "urn:example:Tanks"  inherits: Events
    inputs: new message_def QueryTanks { code: 0xD201 }
    outputs: new message_def ReportTanks { code: 0xD401  record TanksRec {
        fixed_field Level { type: uint16  units: "percent"  scale: { lower: 0  upper: 100 } }
    } }
} }
"""
WITH_TANK = (
    "jausml import ros ../abyss_msgs -o models/",
    "jausml new bridge main odom:nav_msgs/Odometry --yes",
)
SERVICE = "jausml new service Tanks"


@dataclass(frozen=True)
class Row:
    """A message and its situation, in a project."""

    command: str
    told: tuple[str, ...]
    status: int = 2
    folder: str = "."
    before: tuple[str, ...] = ()
    files: dict[str, str] = field(default_factory=dict)


ROWS = {
    "a topic fits several maps": Row(
        "jausml new bridge main cmd_vel:geometry_msgs/TwistStamped",
        (
            "cmd_vel fits several maps: name one, or take the first by --yes",
            "cmd_vel:geometry_msgs/TwistStamped:velocity_command_stamped: SetVelocityCommand",
        ),
    ),
    "no map carries a type": Row(
        "jausml new connection tank:abyss_msgs/Tank",
        (
            "no ready map carries abyss_msgs/Tank of tank",
            "jausml new map tank MESSAGE abyss_msgs/Tank begins one",
        ),
        before=WITH_TANK,
    ),
    "a type is not there": Row(
        "jausml new map tank ReportLocalPose abyss_msgs/Tank",
        ("there is no ROS type 'abyss_msgs/Tank'", "'jausml import ros abyss_msgs' brings"),
        before=WITH_TANK[1:],
    ),
    "a text has no system": Row(
        f"{SERVICE} -m models/g.ros2jaus",
        ("System 'g' follows from the rest of models/g.ros2jaus", "put system g { ... } around"),
        files={"models/g.ros2jaus": "bridge b { address: 100.1.1 }\n"},
    ),
    "a service is of two imports": Row(
        "jausml validate m.ros2jaus",
        ("JML216 'PrimitiveManipulator'", "drop one of the imports", "or say where the other one"),
        1,
        files={
            "m.ros2jaus": "import `jaus.manipulator-1.0`\nimport `jaus.manipulator-2.0`\n"
            "component c { address: 1.1.1  provides: PrimitiveManipulator }\n"
        },
    ),
    "a map is not whole": Row(
        "jausml validate c.ros2jaus --strict",
        (
            *("JML416", "assign it, or add an Ignore", "JML455", "state a freshness"),
            *("JML451", "give it a safeValue, or the map a stopRos"),
        ),
        1,
        files={"c.ros2jaus": SPEED},
    ),
    "ocu knows no such message": Row(
        "jausml ocu query 100.1.1 QueryTanks",
        ("no message 'QueryTanks'", "known in their project, elsewhere by --model FILE"),
        folder="..",
    ),
    "a field has no such unit": Row(
        """jausml encode SetJointPositions 'JointPositionList[0].JointPosition.radians=1'""",
        ("JointPosition.radians: unknown field", "did you mean radian?"),
        1,
    ),
    "a value has no such name": Row(
        "jausml encode SetMode Mode=fly",
        ("'fly' is no name of a legal value", "they are 0 (hold), 1 (go)"),
        1,
        files={"models/modes.ros2jaus": MODES},
    ),
    "a field is inside of another": Row(
        """jausml encode '{"message":"SetElement","fields":{"SetElementSeq":{"RequestID":1}}}'""",
        ("SetElementSeq.RequestID: unknown field", "did you mean RequestIDRec?"),
        1,
    ),
    "a package is not built": Row(
        "jausml run ws",
        ("needs abyss_msgs, which Python does not find", "`colcon build` where the sources of"),
        before=(
            *WITH_TANK,
            "jausml new map tank ReportTanks abyss_msgs/Tank --yes",
            "jausml new connection tank:abyss_msgs/Tank --yes",
            "jausml generate -o ws",
        ),
        files={"models/tanks.ros2jaus": TANKS},
    ),
    "an element of JSIDL is missing": Row(
        "jausml import jsidl boom.xml -o models/",
        ("boom.xml:", ": error: ", "presence_vector"),
        1,
        files={"boom.xml": JSIDL},
    ),
    "a file is there": Row(
        "jausml import ros ../abyss_msgs -o models/",
        ("models/abyss_msgs.xmi is there and differs", "--force overwrites it"),
        files={"models/abyss_msgs.xmi": "other"},
    ),
    "a unit is unknown": Row(
        "jausml validate u.ros2jaus --strict",
        ("u.ros2jaus:7:49: warning: JML432", "'hectare' is no known unit", "did you mean"),
        1,
        files={"u.ros2jaus": SPEED.replace("Fast { type: uint8 }", UNIT)},
    ),
    "a conflict is not resolved": Row(
        "jausml validate x.ros2jaus",
        ("x.ros2jaus:2:1: error: JML009 an unmerged conflict stands in lines 2-4", "1 error in"),
        1,
        files={"x.ros2jaus": f"{DRIVE}<<<<<<< a\n=======\n>>>>>>> b\n"},
    ),
    "a skeleton imports what is gone": Row(
        "jausml generate v.ros2jaus -o ws",
        (
            "own.py:1:23: error: JML905 v.messages has no Gone any more",
            "take it out",
            "--fix changes",
        ),
        1,
        files={
            "v.ros2jaus": "component v { address: 100.1.1  provides: LocalPoseSensor }\n",
            "ws/v/v/own.py": "from .messages import Gone\n",
        },
    ),
}


@pytest.fixture
def project(tmp_path, monkeypatch):
    """An empty project beside a package of messages, as the current folder."""
    messages = tmp_path / "abyss_msgs" / "msg" / "Tank.msg"
    messages.parent.mkdir(parents=True)
    messages.write_text(TANK)
    messages.parents[1].joinpath("package.xml").write_text(PACKAGE)
    monkeypatch.chdir(tmp_path)
    assert run("jausml init abyss --from empty --notation text").exit_code == 0
    monkeypatch.chdir(tmp_path / "abyss")
    return tmp_path / "abyss"


def run(command, *words):
    return CliRunner().invoke(main, [*shlex.split(command)[1:], *words])


def said(output, told):
    """Returns the first part that is not said after those before it; empty for none."""
    place = 0
    for part in told:
        place = output.find(part, place)
        if place < 0:
            return part
    return ""


@pytest.mark.parametrize("name", ROWS)
def test_a_message_says_what_to_do_next(name, project, monkeypatch):
    row = ROWS[name]
    for file, text in row.files.items():
        path = project / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for command in row.before:
        done = run(command)
        assert done.exit_code == 0, done.output
    monkeypatch.chdir(project / row.folder)
    done = run(row.command)
    assert done.exit_code == row.status, done.output
    assert not said(done.output, row.told), done.output


def test_a_refusal_says_who_controls_and_what_preempts(vehicle, free_port):
    target = vehicle(control_timeout=0)
    rival = JausAddress(9, 1, 1)
    target._jaus_access._request(RequestControl(authority_code=255), rival)
    command = "jausml ocu command 100.1.1 SetWrenchEffort PropulsiveLinearEffortX=50"
    done = run(command, "--port", str(free_port))
    assert done.exit_code == 1, done.output
    told = (
        "100.1.1 gives no control: 9.1.1 controls it with authority 255",
        "a higher authority preempts",
    )
    assert not said(done.output, told), done.output


def test_a_connection_that_fails_says_why_and_what_to_change():
    connection = Reporting("c")
    connection.counters = Counters()
    for _ in range(FEWEST_FAILURES):
        connection.fail(AbsentFieldError("position"))
    told = "no message can be translated: absent_field (position); change its map, or what is sent"
    assert connection._failing() == told
