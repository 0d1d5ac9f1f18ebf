"""The classes of the jaus language with their features.

Written by tools/build_model_types.py from jaus.ecore: do not edit.
"""

from collections import abc
from typing import Literal

from jausml.language.metamodel.classes import bridge, system
from jausml.language.metamodel.classes.ecore import EEnumLiteral, EObject

class NumericType(EEnumLiteral):
    """Wire type of a number, little endian."""

    name: Literal[
        "uint8",
        "int8",
        "uint16",
        "int16",
        "uint32",
        "int32",
        "uint64",
        "int64",
        "float32",
        "float64",
    ]

class PresenceVector(EEnumLiteral):
    """Width of the presence vector that precedes a record or sequence."""

    name: Literal[
        "none",
        "uint8",
        "uint16",
        "uint32",
        "uint64",
    ]

class Frame(EEnumLiteral):
    """Axes to which a coordinate, a rate or an angle belongs.

    Names of members tell which axis it is: x, roll; y, pitch; z, yaw, heading.
    """

    name: Literal[
        "unstated",
        "forwardLeftUp",
        "forwardRightDown",
        "eastNorthUp",
        "northEastDown",
        "localUp",
        "localDown",
        "geodetic",
    ]

class Rounding(EEnumLiteral):
    """How a real value becomes the integer of a scaled field (AS5684 integer_function)."""

    name: Literal[
        "round",
        "floor",
        "ceiling",
    ]

class TransitionKind(EEnumLiteral):
    """What taking a transition does to the state (AS5684 transition)."""

    name: Literal[
        "simple",
        "internal",
        "push",
        "pop",
    ]

class SubsystemType(EEnumLiteral):
    """What a component reports as its type in ReportIdentification (AS5710, message 4B00h)."""

    name: Literal[
        "vehicle",
        "ocu",
        "other",
        "node",
        "payload",
        "component",
    ]

class EventType(EEnumLiteral):
    """When a report is sent to its subscriber."""

    name: Literal[
        "periodic",
        "everyChange",
        "oneTime",
    ]

class SilentPolicy(EEnumLiteral):
    """What a component does when a report that it receives has fallen silent."""

    name: Literal[
        "stay",
        "standby",
    ]

class CoreServices(EEnumLiteral):
    """Whether a component provides the core services of AS5710 that its model does not name."""

    name: Literal[
        "standard",
        "none",
    ]

class PeerChoice(EEnumLiteral):
    """Which of the components that a search finds are taken."""

    name: Literal[
        "nearest",
        "first",
        "all",
    ]

class SearchScope(EEnumLiteral):
    """How far from the component that searches others are looked for."""

    name: Literal[
        "system",
        "subsystem",
        "node",
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

class ServiceSet(NamedElement):
    """A named collection of services, for example the core or the mobility service set."""

    version: str
    """Version of the set."""

    types: abc.Sequence[Field]
    """Types declared for re-use by messages of this or other sets (AS5684 declared_type_set)."""

    services: abc.Sequence[Service]
    """The services of the set."""

    def eContainer(self) -> system.System | None:
        """Returns the element that owns this one, None for a root."""

class Service(NamedElement):
    """A JAUS service: a URN with a version and the messages that it takes and sends.

    It inherits the messages and the behaviour of another service.
    """

    urn: str
    """Uniform resource name, for example urn:jaus:jss:mobility:PrimitiveDriver.

    Compared case-sensitively.
    """

    version: str
    """Version of the service."""

    inherits: Service | None
    """The service whose messages and protocol behaviour this one extends (AS5684 inherits_from)."""

    inputs: abc.Sequence[MessageDef]
    """Messages that a provider of the service accepts."""

    outputs: abc.Sequence[MessageDef]
    """Messages that a provider of the service sends."""

    events: abc.Sequence[InternalEvent]
    """Internal events of the service."""

    machines: abc.Sequence[StateMachine]
    """Protocol behaviour of the service.

    None means that a component handles each message by itself.
    """

    def eContainer(self) -> ServiceSet | None:
        """Returns the element that owns this one, None for a root."""

class MessageDef(NamedElement):
    """A message: its code and the layout of its body."""

    code: str
    """Message code, unique within the service and those that it inherits."""

    isCommand: bool
    """True when the message is of the command class: a component obeys it only from its
    controller (AS5710, AccessControl)."""

    moves: bool
    """False for a command that sets nothing in motion, such as SetLocalPose, which states where the
    vehicle is, or a command of a lamp: nothing has to stop it, and its last message stands when the
    source is lost.

    A command of which nothing is said counts as one that moves.
    """

    body: Field | None
    """The body: a record, list, variant or sequence, or a reference to a declared one.

    No body means a message of its code alone.
    """

    def eContainer(self) -> Service | None:
        """Returns the element that owns this one, None for a root."""

class Field(NamedElement):
    """A part of a message body."""

    optional: bool
    """True when the presence vector of the enclosing record or sequence says whether the field
    is there."""

    frame: Frame
    """Axes to which the values of the field belong; members without an own statement take that
    of the field around them."""

    def eContainer(
        self,
    ) -> (
        ServiceSet | MessageDef | Record | Sequence | List | Variant | Array | InternalEvent | None
    ):
        """Returns the element that owns this one, None for a root."""

class TypeReference(Field):
    """Stands for a declared type; its own name and optionality override those of the target."""

    target: Field
    """The declared type."""

class Record(Field):
    """Fields one after the other (AS5684 record).

    Members are fixed, variable, bit, string and array fields.
    """

    presenceVector: PresenceVector
    """Width of the presence vector at the start of the record."""

    fields: abc.Sequence[Field]
    """The members in wire order."""

class Sequence(Field):
    """Containers one after the other (AS5684 sequence).

    Members are records, lists, variants and sequences.
    """

    presenceVector: PresenceVector
    """Width of the presence vector at the start of the sequence."""

    fields: abc.Sequence[Field]
    """The members in wire order."""

class List(Field):
    """A count followed by that many elements (AS5684 list)."""

    countType: NumericType
    """Unsigned integer type of the count."""

    minimumCount: int
    """Smallest legal number of elements."""

    maximumCount: int
    """Largest legal number of elements; 0 means as many as the count type can say."""

    element: Field
    """The container that is repeated."""

class Variant(Field):
    """A tag followed by the option that it names (AS5684 variant).

    The tag is the position of the option, counted from 0.
    """

    tagType: NumericType
    """Unsigned integer type of the tag."""

    options: abc.Sequence[Field]
    """The containers to choose from."""

class FixedField(Field):
    """A number (AS5684 fixed_field)."""

    type: NumericType
    """Wire type."""

    units: str | None
    """Unit of the value, for example meter per second."""

    scale: ScaleRange | None
    """Maps the unsigned integer on the wire to a real value.

    Excludes a value set.
    """

    values: ValueSet | None
    """The legal integers and their meaning."""

class VariableField(Field):
    """A number whose wire type and unit are chosen by an index on the wire (AS5684
    variable_field)."""

    alternatives: abc.Sequence[Alternative]
    """What may be chosen."""

class Alternative(NamedElement):
    """One type that a variable field may take."""

    index: int
    """Value of the type index on the wire (one byte)."""

    type: NumericType
    """Wire type."""

    units: str | None
    """Unit of the value."""

    scale: ScaleRange | None
    """Scaling of the value."""

    values: ValueSet | None
    """The legal integers."""

    def eContainer(self) -> VariableField | None:
        """Returns the element that owns this one, None for a root."""

class BitField(Field):
    """An unsigned integer divided into groups of bits (AS5684 bit_field)."""

    type: NumericType
    """Unsigned integer type."""

    subFields: abc.Sequence[SubField]
    """The groups of bits."""

class SubField(NamedElement):
    """A group of bits of a bit field; bit 0 is the least significant."""

    lowBit: int
    """Index of the lowest bit."""

    highBit: int
    """Index of the highest bit."""

    values: ValueSet | None
    """The legal integers."""

    def eContainer(self) -> BitField | None:
        """Returns the element that owns this one, None for a root."""

class FixedLengthString(Field):
    """Text of a fixed number of bytes, padded with zeros (AS5684 fixed_length_string)."""

    length: int
    """Number of bytes."""

class VariableLengthString(Field):
    """A count and that many bytes of text (AS5684 variable_length_string)."""

    countType: NumericType
    """Unsigned integer type of the count."""

    minimumLength: int
    """Smallest legal length."""

    maximumLength: int
    """Largest legal length; 0 means as many bytes as the count type can say."""

class VariableLengthField(Field):
    """A count and that many bytes in a named format, for example a whole message (AS5684
    variable_length_field)."""

    countType: NumericType
    """Unsigned integer type of the count."""

    format: str
    """Format of the bytes; JAUS MESSAGE means a message code and a body."""

    minimumLength: int
    """Smallest legal length."""

    maximumLength: int
    """Largest legal length; 0 means as many bytes as the count type can say."""

class VariableFormatField(Field):
    """A format index (one byte), a count and that many bytes (AS5684 variable_format_field)."""

    countType: NumericType
    """Unsigned integer type of the count."""

    minimumLength: int
    """Smallest legal length."""

    maximumLength: int
    """Largest legal length; 0 means as many bytes as the count type can say."""

    formats: abc.Sequence[Format]
    """The formats to choose from."""

class Format(NamedElement):
    """One format of a variable format field."""

    index: int
    """Value of the format index on the wire."""

    def eContainer(self) -> VariableFormatField | None:
        """Returns the element that owns this one, None for a root."""

class Array(Field):
    """A fixed number of equal fields without a count (AS5684 array)."""

    element: Field
    """The field that is repeated."""

    dimensions: abc.Sequence[int]
    """Size of each dimension; the first varies slowest."""

class ScaleRange(EObject):
    """Maps the whole range of an unsigned integer of n bits onto real values: value = lower +
    raw * (upper - lower) / (2^n - 1)."""

    lower: float
    """Value of the integer 0."""

    upper: float
    """Value of the largest integer."""

    rounding: Rounding
    """How a value between two integers is encoded."""

    def eContainer(self) -> FixedField | Alternative | None:
        """Returns the element that owns this one, None for a root."""

class ValueSet(EObject):
    """The legal values of a field."""

    values: abc.Sequence[Value]
    """Enumerated values and ranges."""

    offsetToLowerLimit: bool
    """True when the integer on the wire is the value less the lower limit of the set, so that
    1000..1200 fits a uint8 as 0..200.

    The lower limit is the smallest listed value or limit of a range, and an integer (AS5684
    offset_to_lower_limit).
    """

    def eContainer(self) -> FixedField | Alternative | SubField | None:
        """Returns the element that owns this one, None for a root."""

class Value(EObject):
    """Part of a value set."""

    documentation: str | None
    """What the element is for, in plain text.

    It is carried into generated documentation; XML comments would be lost when Eclipse saves the
    model.
    """

    def eContainer(self) -> ValueSet | None:
        """Returns the element that owns this one, None for a root."""

class EnumeratedValue(Value):
    """One integer with a meaning."""

    name: str
    """Meaning of the value."""

    value: int
    """The integer; on the wire too, unless the set counts from its lower limit."""

class ValueRange(Value):
    """A range of legal values."""

    lower: float
    """Lower limit."""

    upper: float
    """Upper limit."""

    lowerInclusive: bool
    """True when the lower limit itself is legal."""

    upperInclusive: bool
    """True when the upper limit itself is legal."""

class InternalEvent(NamedElement):
    """Something that happens inside a component and triggers transitions, such as the end of a
    time-out (AS5684 event_def)."""

    body: Field | None
    """What the event carries; none means nothing."""

    def eContainer(self) -> Service | None:
        """Returns the element that owns this one, None for a root."""

class StateMachine(NamedElement):
    """Protocol behaviour of a service (AS5684 state_machine).

    A machine with the name of one that the service inherits extends it: a state with the same path
    is the same state. One named ReceiveFSM extends that of the core services, whose states the
    component keeps; any other stands for itself.
    """

    states: abc.Sequence[State]
    """The outermost states."""

    def eContainer(self) -> Service | None:
        """Returns the element that owns this one, None for a root."""

class State(NamedElement):
    """A state, with the states inside it (AS5684 state).

    Its name may be a path, for example Receiving.Ready.Controlled.Available.Ready: then nothing
    need be said of the states that enclose it.
    """

    initial: bool
    """True when entering the enclosing state or machine enters this one.

    Exactly one state of each group is initial; in a group that extends inherited states none need
    be.
    """

    entry: abc.Sequence[Action]
    """What is done on entering the state."""

    exit: abc.Sequence[Action]
    """What is done on leaving the state."""

    transitions: abc.Sequence[Transition]
    """Transitions of the state, tried in this order; the first whose guard holds is taken."""

    defaults: abc.Sequence[Transition]
    """Transitions that hold in every state inside this one, where that has none for the trigger
    whose guard holds (AS5684 default_state)."""

    states: abc.Sequence[State]
    """The states inside this one."""

    def eContainer(self) -> StateMachine | State | None:
        """Returns the element that owns this one, None for a root."""

class Transition(EObject):
    """What happens on a message or an internal event (AS5684 transition).

    Without a message and an event it is taken on every trigger that has no transition of its own
    (AS5684 default_transition).
    """

    message: MessageDef | None
    """The message that triggers the transition: one that the service or a service that it
    inherits takes."""

    event: str | None
    """Name of the internal event that triggers the transition: one of the service or of a
    service that it inherits, for example Timedout of AccessControl."""

    guard: str | None
    """Condition of the transition: names of conditions, joined by &&, || and !, with parentheses,
    for example isControllingClient && !isLoaded.

    Each name becomes a method of the component. Empty means always.
    """

    kind: TransitionKind
    """What taking the transition does to the state."""

    target: str | None
    """Path of the state to enter, names joined by dots, from the outermost state or from a state
    that the source encloses, stands beside, or lies in, for example Idle or Moving.PayingOut."""

    actions: abc.Sequence[Action]
    """What is done when the transition is taken, after the exit and before the entry actions."""

    documentation: str | None
    """Why the transition is taken, in plain text."""

    def eContainer(self) -> State | None:
        """Returns the element that owns this one, None for a root."""

class Action(EObject):
    """Something that the component does: a message that it sends, or a method of the component."""

    name: str
    """Name of the method; for an action that sends a message, of the method that makes the
    message."""

    sends: MessageDef | None
    """The message that is sent to the sender of the message that triggered the transition, or to
    the controller when no message did; none for an action that is only a method."""

    arguments: abc.Sequence[str]
    """Arguments as AS5684 writes them; kept for the reader, since the method is given the
    message and its sender."""

    documentation: str | None
    """What the action does, in plain text."""

    def eContainer(self) -> State | Transition | None:
        """Returns the element that owns this one, None for a root."""

class Component(NamedElement):
    """A JAUS component of the system: an address, the services that it provides and its connections
    to other components.

    A component package is generated from it.
    """

    address: str
    """Address subsystem.node.component, unique within the system: 1..65534 .

    1..254 . 1..254 (AS5669A).
    """

    type: SubsystemType
    """Type that Discovery reports for the component."""

    external: bool
    """True for a component that exists already, such as hardware or the program of somebody
    else: nothing is generated or started for it, and rules know its address and what it
    provides."""

    simulated: bool
    """True for a component with no machine behind it yet: what it is told to set it keeps, and
    reports as if it were so, until its methods are written.

    It says so when it starts. Nothing that moves people or things is to run with it.
    """

    endpoint: str | None
    """Where an external component is reached, for networks on which multicast does not find it.

    Processes send to it there from the start; the option --jaus-peer overrides it. Without a port
    it is 3794.
    """

    greet: bool
    """True for an external component that says nothing before it is spoken to.

    Each component and bridge of the system asks it for its identification (AS5710,
    QueryIdentification) every five seconds until it says anything, and again when it was silent for
    a minute. The scope of the question follows from its type: subsystem of a vehicle, ocu or other,
    node of a node, component otherwise.
    """

    coreServices: CoreServices
    """Whether the component provides core services that the model does not name.

    Of an external component only what the model names is known.
    """

    provides: abc.Sequence[Service]
    """Services that the component provides.

    Inherited services come along.
    """

    uses: abc.Sequence[Service]
    """Services of other components that this one sends messages to."""

    connections: abc.Sequence[ServiceConnection]
    """Reports of other components that this one receives."""

    controls: abc.Sequence[Component]
    """Components whose control this one acquires and keeps, and which it resumes, so that they
    obey its commands (AS5710, AccessControl and Management)."""

    authority: int
    """Authority code that the component requests control with, 0..255."""

    defaultAuthority: int
    """Lowest authority code that may control this component, 0..255."""

    controlTimeout: int
    """Seconds after which control lapses unless it is requested again; 0 means never (AS5710,
    QueryTimeout)."""

    eventTimeout: int
    """Minutes after which an event lapses unless it is updated; 0 means never (AS5710,
    QueryEventTimeout)."""

    dependencies: abc.Sequence[str]
    """Packages or rosdep keys that the user's code in the skeleton needs at run time; they join
    those of the generated code in package.xml."""

    def eContainer(self) -> system.System | None:
        """Returns the element that owns this one, None for a root."""

class ServiceConnection(NamedElement):
    """A report that flows from a provider to the component that owns the connection, over an
    AS5710 event or as the answer to one query."""

    provider: Component | None
    """The component that sends the report; absent when it is searched for."""

    search: PeerSearch | None
    """How the components that send the report are found at run time, instead of a provider."""

    message: MessageDef
    """The report."""

    query: MessageDef | None
    """The query that asks for the report; found by name when absent (QueryX for ReportX)."""

    exchange: EventType
    """When the report is sent."""

    rate: float
    """Reports each second of a periodic connection, above 0 and up to 1092."""

    silenceTimeout: float
    """Seconds without a report after which the component is told that the provider has fallen
    silent; 0 means never."""

    whenSilent: SilentPolicy
    """What the component does besides when the provider has fallen silent: which of its states
    is the degraded one, a person decides."""

    def eContainer(self) -> Component | None:
        """Returns the element that owns this one, None for a root."""

class PeerSearch(EObject):
    """A search for the components at the other end of a connection, by what they provide: they
    are found by Discovery (AS5710) at run time, kept while they live, and looked for again when
    they are gone."""

    services: abc.Sequence[Service]
    """Services that a component must provide, all of them; of any version."""

    subsystem: int
    """Id of the subsystem in which they are, 1..65534; 0 means any."""

    node: int
    """Id of the node on which they are, 1..254; 0 means any."""

    within: SearchScope
    """How far from the component that searches they may be."""

    choice: PeerChoice
    """Which of those that are found are taken.

    One that is taken is kept while it lives, also when a nearer one is found later.
    """

    def eContainer(
        self,
    ) -> (
        ServiceConnection
        | bridge.Connection
        | bridge.RosServiceConnection
        | bridge.RosActionConnection
        | None
    ):
        """Returns the element that owns this one, None for a root."""
