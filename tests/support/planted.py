"""Mistakes that are planted in a model, and what must notice each."""

from typing import TypeVar

T = TypeVar("T")

TURN, SPEED = ("Turn -> turn", "turn -> Turn"), ("Speed -> speed", "speed -> Speed")
TEMPERATURES = "BowTemp -> bow_temp\n        SternTemp -> stern_temp"
BACK = "bow_temp -> BowTemp\n        stern_temp -> SternTemp"
CROSSED = "BowTemp -> stern_temp\n        SternTemp -> bow_temp"
CROSSED_BACK = "stern_temp -> BowTemp\n        bow_temp -> SternTemp"
TABLE = "SHUT <-> 0  OPEN <-> 1  JAMMED <-> 9"
VECTORS = """\
    vector starboard JAUS->ROS (
        Turn = 0.5  Speed = 1
        =>
        turn = 0.5 ~ 1e-4  speed = 1 ~ 1e-4
    )
    vector back ROS->JAUS (
        turn = 0.5  speed = 1
        =>
        Turn = 0.5 ~ 1e-4  Speed = 1 ~ 1e-4
    )
"""
LOWER = 'message: LowerRamp  guard: "isControllingClient"  target: "Down"'
RAISE = 'message: RaiseRamp  guard: "isControllingClient"  target: "Up"'
DRIVE = "connection drive { map: drive"
STOP = "stopRos: {}"
DRAUGHT = 'draught { type: float64  units: "m" }'
CONTRADICTION = 'isControllingClient && !isControllingClient"'
HOST = '    allowedHosts: "127.0.0.1"\n'
VALUE = "stopRos: {{ values: {{ target: {}  value: {} }} }}"


def _both(ways: tuple[str, str], step: str, inverse: str) -> list[tuple[str, str]]:
    return [(each, f"{each} : {by}\n") for each, by in zip(ways, (step, inverse), strict=True)]


def _by(who: T, *changes: tuple[str, str]) -> tuple[T, list[tuple[str, str]]]:
    return who, list(changes)


V, C, M = "validate", "case", "model-check"

PLANTED = {
    # Tables and values.
    "two names exchanged by number": _by((V, C), (TABLE, "SHUT <-> 1  OPEN <-> 0  JAMMED <-> 9")),
    "two names exchanged by name": _by(
        (V, C), (TABLE, "SHUT <-> OPEN  OPEN <-> SHUT  JAMMED <-> 9")
    ),
    "a third name exchanged": _by((V, C), (TABLE, "SHUT <-> 9  OPEN <-> 1  JAMMED <-> 0")),
    "a number that no constant has": _by((V, C), (TABLE, "SHUT <-> 0  OPEN <-> 1  JAMMED <-> 2")),
    "a value that the field does not have": _by((V, C), (TABLE, "SHUT <-> 0  OPEN <-> 1  7 <-> 9")),
    "an entry left out": _by((V, C), (TABLE, "SHUT <-> 0  OPEN <-> 1")),
    "two names onto one": _by((V, C), (TABLE, "SHUT <-> 0  OPEN <-> 0  JAMMED <-> 9")),
    "an enumeration without its table": _by(
        (V, C), (" : look_up(gates)", ""), (f"    table gates ( {TABLE} )\n", "")
    ),
    "other numbers of one name": _by(
        (V, C), ("PUMP_ON { type: uint8  value: 1 }", "PUMP_ON { type: uint8  value: 2 }")
    ),
    "constants exchanged in the interface": _by(
        (V, C),
        ("GATE_SHUT { type: uint8  value: 0 }", "GATE_SHUT { type: uint8  value: 1 }"),
        ("GATE_OPEN { type: uint8  value: 1 }", "GATE_OPEN { type: uint8  value: 0 }"),
    ),
    # Signs.
    "sign, to ROS": _by((V, C), (TURN[0] + "\n", TURN[0] + " : negate\n")),
    "sign, to JAUS": _by((V, C), (TURN[1] + "\n", TURN[1] + " : negate\n")),
    "sign both ways": _by((V, C), *_both(TURN, "negate", "negate")),
    "sign both ways, no vector": _by((V, C), *_both(TURN, "negate", "negate"), (VECTORS, "")),
    "sign of the speed both ways": _by((V, C), *_both(SPEED, "negate", "negate")),
    "sign by a factor both ways, no vector": _by(
        (V, C), *_both(TURN, "scale(-1)", "scale(-1)"), (VECTORS, "")
    ),
    "no vector of what has a direction": _by((C,), (VECTORS, "")),
    # Units and factors.
    "feet, one way": _by((V, C), ("Draught -> draught\n", "Draught -> draught : scale(3.28)\n")),
    "feet, both ways": _by(
        (C,),
        *_both(("Draught -> draught\n", "draught -> Draught\n"), "scale(3.28084)", "scale(0.3048)"),
    ),
    "kelvin, both ways": _by(
        (C,),
        *_both(
            ("BowTemp -> bow_temp\n", "bow_temp -> BowTemp\n"),
            "linear(1, 273.15)",
            "linear(1, -273.15)",
        ),
    ),
    "degrees, both ways": _by((V, C), *_both(TURN, "scale(57.29578)", "scale(0.01745329)")),
    "a factor both ways with a vector": _by((V, C), *_both(SPEED, "scale(2)", "scale(0.5)")),
    "an offset one way": _by((V, C), (SPEED[0] + "\n", SPEED[0] + " : linear(1, 0.5)\n")),
    "metres from degrees Celsius": _by((V, C), ("draught -> Draught", "bow_temp -> Draught")),
    "a unit of another dimension": _by((V, C), (DRAUGHT, 'draught { type: float64  units: "s" }')),
    "no unit at one end": _by((C,), (DRAUGHT, "draught { type: float64 }")),
    "a unit that nobody knows": _by(
        (V, C), (DRAUGHT, 'draught { type: float64  units: "fathoms of old" }')
    ),
    # Members.
    "members crossed one way": _by((V, C), (TEMPERATURES, CROSSED)),
    "members crossed the other way": _by((V, C), (BACK, CROSSED_BACK)),
    "members crossed both ways": _by((V, C), (TEMPERATURES, CROSSED), (BACK, CROSSED_BACK)),
    "two targets from one source": _by(
        (V, C), ("stern_temp -> SternTemp", "bow_temp -> SternTemp")
    ),
    "a required member left out": _by((V,), ("        draught -> Draught\n", "")),
    # Stops.
    "no stop": _by((V, C), (f"    {STOP}\n", "")),
    "a stop that drives": _by((V, C), (STOP, VALUE.format("speed", "3"))),
    "a stop that drives back": _by((V, C), (STOP, VALUE.format("speed", "-0.5"))),
    "a safe value that drives": _by(
        (V, C), (DRIVE, f"{DRIVE}  safeValue: {{ target: speed  value: 1 }}")
    ),
    "a member that drives by default": _by(
        (V, C), ("speed { type: float64", 'speed { type: float64  defaultValue: "2"')
    ),
    "no stop upon silence": _by((V, C), ("silenceTimeout: 0.5", "silenceTimeout: 0")),
    "a hold without a reason": _by((V, C), ("silenceTimeout: 0.5", "onSilence: hold")),
    "a hold with a word for a reason": _by(
        (V, C), ("silenceTimeout: 0.5", 'onSilence: hold holdReason: "todo"')
    ),
    "no stop, and the reason of a person": _by(
        (C,), ("silenceTimeout: 0.5", 'onSilence: hold holdReason: "the cable stops it"')
    ),
    "moves false": _by(
        (C,),
        ("0xD101  isCommand: true", "0xD101  isCommand: true  moves: false"),
        (f"    {STOP}\n", ""),
    ),
    "no control that lapses": _by((M,), ("controlTimeout: 2", "controlTimeout: 0")),
    "no guardian": _by((C,), ("controlTimeout: 2", "controlTimeout: 2  guardian: false")),
    # Who commands.
    "no peers": _by((V, C), ("peers: shore  ", ""), (HOST, "")),
    "no hosts": _by((C,), (HOST, "")),
    "one command without its flag and guard": _by(
        (V, C),
        ("0xD103  isCommand: true", "0xD103"),
        ('LowerRamp  guard: "isControllingClient"', "LowerRamp"),
    ),
    # Machines.
    "a trap with a door into itself": _by((M,), (RAISE, RAISE.replace('"Up"', '"Down"'))),
    "a state without a way out": _by((M,), (f" transitions: {{ {RAISE} }}", "")),
    "a guard that contradicts itself": _by(
        (M,), (RAISE, RAISE.replace('isControllingClient"', CONTRADICTION))
    ),
    "no way into a state": _by((V,), (LOWER, LOWER.replace('"Down"', '"Up"'))),
    # Times and limits.
    "no freshness": _by((V, C), ("    freshness: 2\n", "    freshness: 0\n")),
    "no age limit": _by((C,), ("  ageLimit: 0.5", "")),
    "no rate cap": _by((C,), ("  rateCap: 100", "")),
    "two maps on one topic": _by(
        (V, C),
        (
            "    connection hold {",
            "    connection again { map: drive  peers: shore  silenceTimeout: 0.5  "
            "rateCap: 100  ageLimit: 0.5  topic drive { qos: { depth: 1 } } }\n"
            "    connection hold {",
        ),
    ),
}
"""By what it is: who notices it, and the texts of the model that change."""

FOR_PROOFS = [("Speed -> speed\n", "0.5 -> speed\n"), (VECTORS, "")]
"""A constant in place of a member, which a proof of the map must find."""

UNKNOWABLE = {
    "a range that is too small": _by("range", ("lower: 0 upper: 4 }", "lower: 0 upper: 3.5 }")),
    "a limit below the range": _by("range", (TURN[0] + "\n", TURN[0] + " : clamp(-1, 0.9)\n")),
    "a rate that is too low": _by("rate", ("frequency: 10", "frequency: 1")),
    "a stop that comes late": _by(
        "time-out",
        ("silenceTimeout: 0.5", "silenceTimeout: 60"),
        ("controlTimeout: 2", "controlTimeout: 200"),
    ),
    "a sign and a vector that fits it": _by(
        "vector",
        *_both(TURN, "negate", "negate"),
        ("        turn = 0.5 ~", "        turn = -0.5 ~"),
        ("        Turn = 0.5 ~", "        Turn = -0.5 ~"),
    ),
    "a freshness that is too long": _by("time-out", ("freshness: 2", "freshness: 2000")),
    "both definitions wrong alike": _by(
        "definition",
        (DRAUGHT, 'draught { type: float64  units: "ft" }'),
        ("Draught { type: uint16  units: meter", "Draught { type: uint16  units: foot"),
    ),
}
"""By what it is: of which assumption a case speaks instead, and the texts of the model."""
