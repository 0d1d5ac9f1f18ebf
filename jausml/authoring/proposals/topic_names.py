"""The ready map that a topic is for, by its name."""

from __future__ import annotations

from jausml.language.metamodel.classes import bridge
from jausml.language.model.names import name_of
from jausml.language.semantics.names import words

_LONG = {
    "cmd": "command",
    "commands": "command",
    "vel": "velocity",
    "odom": "odometry",
    "accel": "acceleration",
    "history": "historical",
    "plan": "planned",
    "tool": "end_effector",
    "camera": "visual_sensor",
}
"""Words of topics, and what maps write for them."""

_DEVICES = {
    "digital_video": "visual_sensor",
    "travel_speed": "speed",
    "local_vector": "local_velocity",
    "global_vector": "global_velocity",
    "skid_steer_wheels": "wheels",
    "waypoint": "waypoint_pose",
}
"""Words of maps, and what topics mostly write for them."""

_JOINED = ("end_effector", "visual_sensor")
_REPORTING = frozenset({"current", "applied", "report", "state", "states"})
_COMMANDING = frozenset({"command", "goal", "target", "set", "setpoint", "desired"})
_MEANT = {"goal": "waypoint", "target": "waypoint"}
_IDLE = _REPORTING | _COMMANDING | {"local", "stamped", "actual"}
_VALUES = ("std_msgs", "example_interfaces")

_EMERGENCY = (["emergency"], ["estop"], ["e", "stop"])


class TopicName:
    """The words of the name of a topic.

    Attributes:
        commands: Whether they say that it is a command, which moves something.
    """

    def __init__(self, name: str) -> None:
        """Splits the name of a topic, or of a join, into words."""
        own = _split("_".join(_LONG.get(word, word) for word in _lower(name)))
        self._all = {*own, *(_MEANT[word] for word in own if word in _MEANT)}
        self._distinctive = _distinctive(own)
        self.commands = not _COMMANDING.isdisjoint(own) and not {"current", "applied"} & {*own}

    def distance(self, map_: bridge.AttributeMap) -> tuple[bool, int, int, int]:
        """Returns how far a map is from what the name says; the least is the likeliest."""
        own = _of_map(map_)
        missing = self._distinctive - {*own}
        return not self.names(map_), -len(self._all & {*own}), len(missing), len(own)

    def names(self, map_: bridge.AttributeMap) -> bool:
        """Tells whether the name has the distinctive words of a map, and no others."""
        return self._distinctive == _distinctive(_of_map(map_))

    def feeds(self, join: bridge.Join) -> bool:
        """Tells whether the name has all words of a join."""
        return _distinctive(_split(name_of(join).lower())) <= self._distinctive


def is_bare(kind: str) -> bool:
    """Tells whether a type such as `std_msgs/Bool` leaves the meaning of its value open."""
    return kind.partition("/")[0] in _VALUES


def is_emergency_stop(name: str) -> bool:
    """Tells whether a topic or service is called after an emergency stop."""
    own = _lower(name)
    return any(
        own[at : at + len(phrase)] == phrase for phrase in _EMERGENCY for at in range(len(own))
    )


def _of_map(map_: bridge.AttributeMap) -> list[str]:
    name = "_".join(_lower(name_of(map_)))
    for own, usual in _DEVICES.items():
        name = name.replace(own, usual)
    return _split(name)


def _lower(name: str) -> list[str]:
    return [word.lower() for word in words(name)]


def _split(name: str) -> list[str]:
    """Returns the words of a name; compounds stay one word."""
    for compound in _JOINED:
        name = name.replace(compound, compound.replace("_", ""))
    return [word for word in name.split("_") if word]


def _distinctive(own: list[str]) -> set[str]:
    """Returns the words that say which thing is meant; all where none does."""
    return {word for word in own if word not in _IDLE} or {*own}
