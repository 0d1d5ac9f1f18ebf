"""The classes of the bridge language with their features.

Written by tools/build_model_types.py from bridge.ecore: do not edit.
"""

from collections import abc
from typing import Literal

from jausml.language.metamodel.classes import jaus, ros
from jausml.language.metamodel.classes.ecore import EEnumLiteral, EObject

class Direction(EEnumLiteral):
    """Which way a connection carries messages."""

    name: Literal[
        "jausToRos",
        "rosToJaus",
    ]

class Exchange(EEnumLiteral):
    """How the JAUS side of a connection exchanges its message."""

    name: Literal[
        "message",
        "periodicEvent",
        "everyChangeEvent",
        "query",
    ]

class Priority(EEnumLiteral):
    """AS5669A message priority."""

    name: Literal[
        "low",
        "standard",
        "high",
        "safetyCritical",
    ]

class OutOfRangePolicy(EEnumLiteral):
    """What happens to a value that its target field cannot carry; each case is counted by field."""

    name: Literal[
        "clamp",
        "dropMessage",
        "dropField",
        "error",
    ]

class FieldOutOfRangePolicy(EEnumLiteral):
    """What happens to a value that the target of one assignment cannot carry; each case is
    counted by field."""

    name: Literal[
        "asConnection",
        "clamp",
        "dropMessage",
        "dropField",
        "error",
    ]

class AbsentPolicy(EEnumLiteral):
    """What happens when a source is absent: an optional JAUS field that is left out, or a ROS
    field whose marker says that it has no value."""

    name: Literal[
        "unstated",
        "dropMessage",
        "useDefault",
        "lastValue",
        "leave",
        "receptionTime",
    ]

class StalePolicy(EEnumLiteral):
    """What happens to a message when a joined topic has delivered nothing, or nothing fresh."""

    name: Literal[
        "leave",
        "dropMessage",
    ]

class SilentTopicPolicy(EEnumLiteral):
    """What becomes of a report whose ROS topic has delivered nothing, or nothing fresh."""

    name: Literal[
        "absent",
        "keep",
    ]

class ConnectionSilentTopicPolicy(EEnumLiteral):
    """What becomes of the report of one connection whose ROS topic has delivered nothing, or
    nothing fresh."""

    name: Literal[
        "asMap",
        "absent",
        "keep",
    ]

class SilencePolicy(EEnumLiteral):
    """What happens on the other side when the source of a command is lost: it falls silent,
    control ends, the bridge leaves Ready, or the bridge itself ends."""

    name: Literal[
        "stop",
        "hold",
    ]

class Progress(EEnumLiteral):
    """What a number in the feedback of a ROS action says of its list."""

    name: Literal[
        "index",
        "remaining",
        "distance",
    ]

class MissionEnd(EEnumLiteral):
    """What becomes of the mission of a JAUS peer when the goal of a ROS client ends before it:
    the client cancels it, another goal takes its place, control ends, the bridge leaves Ready,
    or the bridge itself ends."""

    name: Literal[
        "open",
        "abort",
        "pause",
    ]

class ConversionKind(EEnumLiteral):
    """Named value conversions.

    Each literal says what it does; the function of the same name computes it at run time.
    """

    name: Literal[
        "negate",
        "scale",
        "linear",
        "clamp",
        "deadband",
        "square",
        "degrees_to_radians",
        "radians_to_degrees",
        "ned_heading_to_enu_yaw",
        "enu_yaw_to_ned_heading",
        "frd_angles_to_flu_quaternion",
        "frd_yaw_to_flu_quaternion",
        "flu_quaternion_to_frd_roll",
        "flu_quaternion_to_frd_pitch",
        "flu_quaternion_to_frd_yaw",
        "ned_angles_to_enu_quaternion",
        "timestamp_to_time",
        "time_to_timestamp",
        "square_root",
        "covariance_to_rms",
        "value_to_percent",
        "percent_to_value",
        "wrap_angle",
        "flu_quaternion_to_frd_angles",
        "enu_quaternion_to_ned_angles",
        "enu_quaternion_to_ned_heading",
        "ned_heading_to_enu_quaternion",
        "occupancy_to_cost",
        "cost_to_occupancy",
        "reverse_rows",
        "with_units",
        "look_up",
        "expression",
        "user",
        "limit",
        "pixels_to_pnm",
        "pnm_to_pixels",
    ]

class NamedElement(EObject):
    """Something with a name and documentation."""

    name: str
    """Name of the element, unique among its siblings.

    Generated code derives identifiers from it.
    """

    documentation: str | None
    """What the element is for, in plain text.

    It is carried into generated documentation; XML comments would be lost when Eclipse saves the
    model.
    """

class DecisionOwner(NamedElement):
    """A map or a connection, of which decisions may be open."""

    openDecisions: abc.Sequence[OpenDecision]
    """What a person has yet to decide.

    Whoever decides removes it.
    """

class OpenDecision(EObject):
    """A decision that no tool can make, since it depends on the vehicle.

    It is open, and validate reports it, until a person has made it and removes it.
    """

    text: str
    """What is to be decided."""

    blocking: bool
    """Whether it is an error, so that nothing is generated, since a safety or the meaning of a
    value hangs on it.

    Otherwise it is a warning.
    """

    def eContainer(self) -> DecisionOwner | None:
        """Returns the element that owns this one, None for a root."""

class AttributeMap(DecisionOwner):
    """Relates one JAUS message and one ROS type, attribute by attribute, for each direction in
    which it is used."""

    message: jaus.MessageDef
    """The JAUS message."""

    type: ros.MessageType
    """The ROS type."""

    toRos: abc.Sequence[Assignment]
    """Assignments that fill the ROS message."""

    toJaus: abc.Sequence[Assignment]
    """Assignments that fill the JAUS message."""

    tables: abc.Sequence[ValueTable]
    """Tables for look_up conversions."""

    quantities: abc.Sequence[Quantity]
    """Quantities that conversions refer to, such as the greatest speed of the vehicle."""

    joins: abc.Sequence[Join]
    """Further ROS topics from which toJaus takes values."""

    reportJoins: abc.Sequence[ReportJoin]
    """Further JAUS reports from which toRos takes values."""

    vectors: abc.Sequence[TestVector]
    """Messages with what they become, checked by the generated tests."""

    freshness: float
    """Seconds after which the latest message of the ROS topic counts as stale for the report
    that it is made into; 0 states nothing."""

    whenStale: SilentTopicPolicy
    """What becomes of the report when there is no fresh message."""

    stopRos: Stop | None
    """The ROS message that stops what a message of this map has set in motion.

    A map whose ROS message cannot say that, such as one of a goal, has none.
    """

    stopJaus: Stop | None
    """The JAUS message that stops what a message of this map has set in motion."""

    def eContainer(self) -> MapLibrary | Bridge | None:
        """Returns the element that owns this one, None for a root."""

class Stop(EObject):
    """A message that stops.

    What the map fills without a source, with constants and the clock, is filled in it too; other
    attributes keep their defaults, which is 0 for numbers.
    """

    values: abc.Sequence[ConstantAssignment]
    """Attributes that a stop needs beyond that."""

    silenceTimeout: float
    """Seconds of silence after which connections by this map send the stop, unless they say it
    themselves.

    0 is for commands that are sent once and stand: their stop is sent for other reasons alone.
    """

    def eContainer(self) -> AttributeMap | None:
        """Returns the element that owns this one, None for a root."""

class MapLibrary(NamedElement):
    """Attribute maps that bridges of several systems use."""

    maps: abc.Sequence[AttributeMap]
    """The maps."""

class ValueTable(NamedElement):
    """Pairs of JAUS and ROS values that mean the same, for look_up."""

    entries: abc.Sequence[TableEntry]
    """The pairs.

    Where a value stands in several, the first one counts.
    """

    def eContainer(self) -> AttributeMap | None:
        """Returns the element that owns this one, None for a root."""

class TableEntry(EObject):
    """A pair of values of a table."""

    jaus: str
    """The JAUS value: a number, the name of an enumerated value, true or false, or text."""

    ros: str
    """The ROS value: a number, the name of a constant of the ROS type, true or false, or text."""

    documentation: str | None
    """What the element is for, in plain text.

    It is carried into generated documentation; XML comments would be lost when Eclipse saves the
    model.
    """

    def eContainer(self) -> ValueTable | None:
        """Returns the element that owns this one, None for a root."""

class Quantity(NamedElement):
    """A number of the vehicle with its unit, such as its greatest speed, that conversions refer
    to."""

    value: float
    """The number."""

    units: str | None
    """Its unit, for example m/s."""

    def eContainer(self) -> AttributeMap | Bridge | None:
        """Returns the element that owns this one, None for a root."""

class Join(NamedElement):
    """A further ROS topic whose latest message is at hand when the main topic of the map delivers.

    Source paths begin with the name of the join.
    """

    type: ros.MessageType
    """The type of the joined topic."""

    freshness: float
    """Seconds after which the latest message counts as stale, above 0."""

    whenStale: StalePolicy
    """What to do when there is no fresh message."""

    def eContainer(self) -> AttributeMap | None:
        """Returns the element that owns this one, None for a root."""

class ReportJoin(NamedElement):
    """A further JAUS report whose latest message is at hand when the message of the map arrives,
    which alone drives: each of its arrivals makes one ROS message.

    Source paths begin with the name of the join.
    """

    message: jaus.MessageDef
    """The joined report."""

    freshness: float
    """Seconds after which the latest report counts as stale, above 0."""

    whenStale: StalePolicy
    """What to do when there is no fresh report."""

    def eContainer(self) -> AttributeMap | None:
        """Returns the element that owns this one, None for a root."""

class TestVector(NamedElement):
    """A source message with what it becomes: a test with figures that were found otherwise than
    by the conversions."""

    direction: Direction
    """Which assignments it tests."""

    given: abc.Sequence[VectorValue]
    """Values of the source message; it has no others."""

    expected: abc.Sequence[VectorValue]
    """Values of the target message."""

    def eContainer(self) -> AttributeMap | None:
        """Returns the element that owns this one, None for a root."""

class VectorValue(EObject):
    """The value of one attribute in a test vector."""

    path: str
    """Path of the attribute; elements of lists are named by index."""

    value: str
    """The value: a number, true, false, text, octets as pairs of hexadecimal digits, or absent
    for an optional field that is left out."""

    tolerance: float
    """Largest difference of a number that is expected; 0 means half a step of the JAUS fields on
    the way."""

    def eContainer(self) -> TestVector | None:
        """Returns the element that owns this one, None for a root."""

class Assignment(EObject):
    """Gives one attribute of the target message its value."""

    target: str
    """Path of the target attribute: names joined by dots, for example pose.pose.position.x or
    Velocity_X.

    Several paths for a conversion that yields several values are joined by commas.
    """

    documentation: str | None
    """What the element is for, in plain text.

    It is carried into generated documentation; XML comments would be lost when Eclipse saves the
    model.
    """

    def eContainer(self) -> AttributeMap | Stop | ListAssignment | Connection | None:
        """Returns the element that owns this one, None for a root."""

class FieldAssignment(Assignment):
    """The target takes the value of one or more attributes of the source message, through
    conversions in order."""

    source: str
    """Path of the source attribute; several paths for a conversion that takes several are joined
    by commas."""

    whenAbsent: AbsentPolicy
    """What to do when the source is absent."""

    outOfRange: FieldOutOfRangePolicy
    """What to do with a value that the target cannot carry; overrides the policy of the
    connection."""

    conversions: abc.Sequence[Conversion]
    """Conversions, applied in order."""

    defaultValue: str | None
    """The value of the target with whenAbsent useDefault: a number, true, false or text, as the
    target needs; where there are several sources, the number that stands for an absent one."""

    precision: float
    """Largest error, in the unit of the target, that rounding in the target may make; 0 means
    that none is stated."""

    def eContainer(self) -> AttributeMap | ListAssignment | None:
        """Returns the element that owns this one, None for a root."""

class ConstantAssignment(Assignment):
    """The target takes a constant."""

    value: str
    """The constant: a number, true, false or text, as the target needs."""

class ClockAssignment(Assignment):
    """The target takes the present time of the clock of the bridge (a ROS time or a JAUS
    TimeStamp)."""

    def eContainer(self) -> AttributeMap | ListAssignment | None:
        """Returns the element that owns this one, None for a root."""

class Ignore(Assignment):
    """States that the attribute is left out on purpose, so that checks do not ask for it."""

    def eContainer(self) -> AttributeMap | ListAssignment | None:
        """Returns the element that owns this one, None for a root."""

class ListAssignment(Assignment):
    """The target list has one element for each element of the source list, filled by assignments of
    its own.

    Their paths start at the elements; "." is an element that has no members, and paths that begin
    with "/" start at the message. Expressions may also use index (from 0) and count.
    """

    source: str
    """Path of the source list; several paths for a conversion that takes several are joined by
    commas."""

    keys: str | None
    """Path of the ROS sequence that holds a name for each element, such as name of
    sensor_msgs/JointState.

    The elements on the JAUS side then are those that names lists, in this order.
    """

    names: abc.Sequence[str]
    """Names of the elements on the JAUS side, in their order."""

    whenAbsent: AbsentPolicy
    """What to do when the source is absent, or when keys lack a name."""

    conversions: abc.Sequence[Conversion]
    """Conversions of the list as a whole, applied in order, before its elements are taken."""

    assignments: abc.Sequence[Assignment]
    """Assignments that fill one element of the target."""

    def eContainer(self) -> AttributeMap | ListAssignment | None:
        """Returns the element that owns this one, None for a root."""

class MessageAssignment(Assignment):
    """The target is a JAUS field that carries a whole JAUS message, or the source is: the
    message is translated by an attribute map of its own, as in the elements of JAUS lists."""

    source: str
    """Path of the source attribute; "." for the element itself."""

    map: AttributeMap
    """The map between the message that the JAUS field carries and the ROS attribute."""

    def eContainer(self) -> AttributeMap | ListAssignment | None:
        """Returns the element that owns this one, None for a root."""

class Conversion(EObject):
    """A named conversion with its arguments."""

    kind: ConversionKind
    """Which conversion."""

    arguments: abc.Sequence[float]
    """Arguments in the order that the conversion names them."""

    expression: str | None
    """The text of an expression: numbers, + - * / ^, parentheses, comparisons, named functions,
    and the sources by the last step of their paths or, for a single one, by value."""

    method: str | None
    """Name of the method of a user conversion; the skeleton has it as convert_<name>."""

    units: str | None
    """The units that with_units states."""

    table: ValueTable | None
    """The table of a look_up."""

    quantity: Quantity | None
    """The quantity that stands for the one argument of a conversion, such as the maximum of
    value_to_percent; arguments are empty then."""

    def eContainer(self) -> FieldAssignment | ListAssignment | None:
        """Returns the element that owns this one, None for a root."""

class Topic(EObject):
    """A ROS topic of a connection."""

    name: str
    """Topic name; relative names are resolved in the namespace of the bridge."""

    qos: ros.QoSProfile | None
    """Quality of service; the default is automatic reliability, volatile, keep last 10."""

    join: Join | None
    """The join that the topic feeds; without it the topic is the one that the map is for."""

    def eContainer(self) -> Connection | None:
        """Returns the element that owns this one, None for a root."""

class ReportSource(EObject):
    """Says for one joined report of a connection from JAUS to ROS who sends it, and how."""

    join: ReportJoin
    """The joined report."""

    peers: abc.Sequence[jaus.Component]
    """JAUS components that send it; none means those of the connection."""

    exchange: Exchange
    """How the report is exchanged."""

    query: jaus.MessageDef | None
    """The query that asks for the report; found by name when absent (QueryX for ReportX)."""

    rate: float
    """Reports each second of periodic events and queries, up to 1092; 0 means the rate of the
    connection, or the frequency of the bridge where that has none."""

    def eContainer(self) -> Connection | None:
        """Returns the element that owns this one, None for a root."""

class Connection(DecisionOwner):
    """Carries one kind of message across the bridge, by one attribute map."""

    map: AttributeMap
    """The attribute map."""

    direction: Direction
    """Which way the messages go."""

    exchange: Exchange
    """How the JAUS side exchanges the message."""

    peers: abc.Sequence[jaus.Component]
    """JAUS components at the other end.

    None means any: messages are taken from whoever sends them, reports go to whoever asks.
    """

    search: jaus.PeerSearch | None
    """How the JAUS components at the other end are found at run time, instead of peers."""

    topics: abc.Sequence[Topic]
    """ROS topics: all are published to, or all are subscribed to."""

    sources: abc.Sequence[ReportSource]
    """Where joined reports of the map come from, where that differs from the message of the map:
    a join without a source comes from the peers of the connection, as a periodic event."""

    query: jaus.MessageDef | None
    """The query that asks for the report; found by name when absent (QueryX for ReportX)."""

    rate: float
    """Messages each second of periodic events and queries, up to 1092; 0 means the frequency of
    the bridge."""

    rateCap: float
    """Messages each second that are taken of one source, and as many at once; 0 means all.

    What comes beyond is dropped and counted as over_rate before it is translated, so that a source
    that sends far too much does not hold up other connections. Beyond 256 sources all others have
    one allowance together. It is for messages that come to the bridge unasked (exchange message,
    jausToRos). The newest is dropped, a stop as well: the cap is well above what a source sends,
    and maxRate is for what comes regularly.
    """

    maxRate: float
    """Messages each second that pass at most; 0 means all.

    Of those that come faster the newest waits until its time has come, so that the last one always
    arrives; the others are counted as thinned. A stop does not wait, and what waits gives way to
    it.
    """

    decimation: int
    """Every how many messages one passes, beginning with the first; 1 means all.

    The others are counted as thinned. With a maxRate it is counted before that.
    """

    ageLimit: float
    """Seconds after which a message is too old to pass; 0 means never.

    Its age is that of its stamp (header.stamp or stamp as the first field of a ROS type, TimeStamp
    of JAUS) by the ROS clock of the bridge, else of its publication by the system clock, else since
    the bridge took it. The clocks of other computers must agree with that of the bridge.
    """

    priority: Priority
    """Priority of JAUS messages that the connection sends."""

    acknowledge: bool
    """True when the JAUS peer shall acknowledge each message."""

    control: bool
    """True when the bridge acquires and keeps control of the peers and resumes them, which
    commands need."""

    outOfRange: OutOfRangePolicy
    """What to do with values that the target cannot carry, for assignments that do not say it
    themselves."""

    silenceTimeout: float | None
    """Seconds without a message from the source after which the stop or safe value is sent once; 0
    means never.

    A command that is not told one takes that of the stop of its map, or 1 second for a safeValue;
    what is no command is not watched then.
    """

    safeValue: abc.Sequence[ConstantAssignment]
    """Attributes of the target message that is sent when the source is lost, in the place of the
    stop of the map.

    What the map fills with constants and the clock is filled too; the others keep their defaults.
    """

    onSilence: SilencePolicy
    """What happens when the source of a command is lost."""

    holdReason: str | None
    """Why it is safe that the last message stands; onSilence hold needs it.

    With a stop it is the reason for a silenceTimeout of 0.
    """

    freshness: float
    """Seconds after which the latest message of the ROS topics counts as stale for the report
    that it is made into; 0 means as the map says."""

    whenStale: ConnectionSilentTopicPolicy
    """What becomes of the report when there is no fresh message."""

    def eContainer(self) -> Bridge | None:
        """Returns the element that owns this one, None for a root."""

class RosServiceConnection(DecisionOwner):
    """Carries the calls of one ROS service across the bridge: a request and its response on the
    ROS side, a query and its report or a command and its confirmation on the JAUS side."""

    direction: Direction
    """Who asks.

    With rosToJaus a ROS client does: the bridge serves the ROS service and asks a JAUS peer. With
    jausToRos a JAUS component asks the bridge, which calls the ROS service.
    """

    service: str
    """Name of the ROS service; relative names are resolved in the namespace of the bridge."""

    type: ros.ServiceType
    """The type of the ROS service."""

    request: AttributeMap | None
    """The map between the JAUS message that asks and the request of the type."""

    response: AttributeMap | None
    """The map between the JAUS message that answers and the response of the type."""

    message: jaus.MessageDef | None
    """The JAUS message that asks, where there is no map of the request: it is sent with its
    defaults, as a query without content is, or taken whatever it holds."""

    answer: jaus.MessageDef | None
    """The JAUS message that answers, where there is no map of the response: the report of a query,
    or the confirmation of a command.

    Without it and without a map a command counts as done when it is sent.
    """

    rejections: abc.Sequence[jaus.MessageDef]
    """JAUS messages that answer too, and say that what was asked for is not done."""

    peers: abc.Sequence[jaus.Component]
    """JAUS components at the other end.

    With rosToJaus the first one that is there, and obeys where control is needed, is asked. With
    jausToRos none means any: whoever asks is answered.
    """

    search: jaus.PeerSearch | None
    """How the JAUS components at the other end are found at run time, instead of peers."""

    timeout: float
    """Seconds after which a call without an answer has failed; a JAUS query is repeated within
    it."""

    control: bool
    """True when the bridge acquires and keeps control of the peers and resumes them, which commands
    need.

    A query needs no control.
    """

    priority: Priority
    """Priority of JAUS messages that the connection sends."""

    successMember: str | None
    """Path of the bool of the response that says whether the call did what it is for, such as
    success of std_srvs.

    With rosToJaus the bridge fills it: false when nobody answered, when the bridge is not in
    control, or when the answer is a rejection. With jausToRos a false one is answered with a
    rejection.
    """

    reasonMember: str | None
    """Path of the string of the response that says why the call failed, such as message of
    std_srvs.

    With rosToJaus the bridge fills it; with jausToRos it goes to the log.
    """

    outOfRange: OutOfRangePolicy
    """What to do with values that the target cannot carry, for assignments that do not say it
    themselves."""

    def eContainer(self) -> Bridge | None:
        """Returns the element that owns this one, None for a root."""

class RosActionConnection(DecisionOwner):
    """Carries lists of elements, such as waypoints, across the bridge: the goal of a ROS action
    on one side, a list and its driver on the JAUS side."""

    direction: Direction
    """Who gives the list, or the mission.

    With jausToRos a JAUS component gives it to the bridge, which is the list driver and has the ROS
    action done. With rosToJaus a ROS client sends a goal to the action that the bridge serves, and
    the bridge gives the list to a JAUS peer and has it executed.
    """

    action: str
    """Name of the ROS action; relative names are resolved in the namespace of the bridge."""

    type: ros.ActionType
    """The type of the ROS action."""

    driver: jaus.Service
    """The list driver: a JAUS service that executes a list, such as LocalWaypointListDriver, or a
    mission, as MissionSpooler does; with jausToRos also a waypoint driver, whose waypoint is a list
    of one.

    The bridge provides it, or a peer does.
    """

    element: AttributeMap
    """The map between the JAUS message that an element of the list holds and the ROS type of one
    element of the goal."""

    goalMember: str
    """Path of the array of the goal that has the elements, such as poses; for a waypoint driver
    also that of a single message, such as pose of NavigateToPose."""

    progressMember: str | None
    """Path of the number of the feedback that says how far the list is done."""

    progress: Progress
    """What the number at progressMember says."""

    reasonMember: str | None
    """Path of the string of the result that says why the list was not done, such as error_msg."""

    speed: float
    """Metres per second that ExecuteList asks for, with rosToJaus; above 0, but for drivers
    whose ExecuteList has none."""

    onEnd: MissionEnd
    """What becomes of a mission whose goal ends before it; with rosToJaus and a mission spooler
    a person decides it."""

    peers: abc.Sequence[jaus.Component]
    """JAUS components at the other end.

    With rosToJaus the first one that is there and obeys gets the list. With jausToRos none means
    any: whoever is in control may give one.
    """

    search: jaus.PeerSearch | None
    """How the JAUS components at the other end are found at run time, instead of peers."""

    timeout: float
    """Seconds after which a message without an answer, or a goal that nobody has accepted, has
    failed; JAUS messages are repeated within it.

    How long a list takes is not limited.
    """

    control: bool
    """True when the bridge acquires and keeps control of the peers and resumes them, which lists
    need."""

    outOfRange: OutOfRangePolicy
    """What to do with values that the target cannot carry, for assignments that do not say it
    themselves."""

    def eContainer(self) -> Bridge | None:
        """Returns the element that owns this one, None for a root."""

class Bridge(jaus.Component):
    """One process that is a JAUS component and a ROS 2 node at the same time and services many
    connections.

    Reports that ROS topics feed are provided by the services of the bridge itself.
    """

    namespace: str
    """ROS namespace of the node; empty means the root."""

    frequency: float
    """Messages each second of the periodic events and queries that state no rate of their own.

    Diagnostics come at this rate too, but not more often than once a second.
    """

    guardian: bool
    """Whether a small process beside the bridge says the stops of its commands and cancels its
    goals when the bridge has died, or does not run its loop for the silenceTimeout of a command, at
    least 0.5 s.

    It starts with the first command that has a stop, or the first goal.
    """

    allowedHosts: abc.Sequence[str]
    """IPv4 addresses and networks, such as 10.0.0.0/24, that JAUS messages are taken from; none
    means any.

    Processes of the same host are always heard. What comes from elsewhere is dropped and counted as
    transport.source_not_allowed.
    """

    fixedSources: bool
    """Whether a component is heard from one endpoint only: over UDP until it was silent there for
    10 s, over TCP until its connection ends.

    What comes in its name from another endpoint is dropped and counted as transport.source_refused.
    False, as AS5669A has it, is that the address of the newest message counts, so that whoever
    sends one message in the name of a component gets what is for it. A component that starts again
    on another port, or takes a shared port over, is refused for as long.
    """

    amplificationLimit: int
    """Bytes that go to a UDP endpoint on another host for each byte from it, until it has
    acknowledged a number that it could not guess: at least 3, or 0 for no limit and no proof.

    Components that the model places on hosts need none.
    """

    maxPeers: int
    """Components that the bridge remembers the addresses of, besides those that the model places
    and the one in control.

    When all places are taken, who has not proved its address gives way, then one of the host that
    has most.
    """

    maxConnections: int
    """TCP connections at a time.

    When all are taken, one that nothing has come by gives way, then one of the host that has most.
    """

    idleTimeout: float
    """Seconds in which a whole message must come over a TCP connection that a peer has made; 0
    for any time."""

    maxEvents: int
    """JAUS events that the bridge serves at a time, at most 255.

    When all are taken, a client without proof gives way, then one of the host that has most.
    Modelled peers and the one in control always get one.
    """

    eventRateBudget: float
    """Reports each second of all periodic JAUS events together.

    When more are asked for, those who ask for more than a fair share get fewer.
    """

    maps: abc.Sequence[AttributeMap]
    """Attribute maps of this bridge."""

    bridgeConnections: abc.Sequence[Connection]
    """Messages of topics that the bridge carries across."""

    serviceConnections: abc.Sequence[RosServiceConnection]
    """ROS services whose calls the bridge carries across."""

    actionConnections: abc.Sequence[RosActionConnection]
    """ROS actions whose goals the bridge carries across."""

    quantities: abc.Sequence[Quantity]
    """Values for this bridge of quantities of its maps, by name."""
