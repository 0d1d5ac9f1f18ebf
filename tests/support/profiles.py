"""What a person decides in the models of `jausml init --from iop-...`, so that they validate."""

ADDRESSES = {
    "iop-ugv": "100.1.1",
    "iop-payload": "100.2.1",
    "iop-manipulator": "100.3.1",
    "iop-operator": "60.1.1",
}
"""The profiles, and the address of the bridge of each."""

_LOCAL = 'allowedHosts: "127.0.0.1" namespace: '
_HOLD = 'onSilence: hold holdReason: "it keeps its place" '
DECISIONS = {
    "iop-ugv": {
        "namespace: vehicle": f"{_LOCAL}vehicle",
        "topic cmd_vel": "silenceTimeout: 0.5 topic cmd_vel",
        "topic parking_brake\n": f"{_HOLD}topic parking_brake\n",
    },
    "iop-payload": {
        "namespace: payload": f"{_LOCAL}payload",
        "topic pan_tilt/velocity_command": "silenceTimeout: 0.5 topic pan_tilt/velocity_command",
    },
    "iop-manipulator": {
        "namespace: arm": f"{_LOCAL}arm",
        "topic joint_velocity_command": "silenceTimeout: 0.2 topic joint_velocity_command",
        "topic tool_effort_command": f"{_HOLD}topic tool_effort_command",
    },
    "iop-operator": {
        "namespace: unit": "authority: 100 namespace: unit",
        "topic cmd_vel": "silenceTimeout: 0.5 topic cmd_vel",
    },
}


def decided(profile: str, text: str) -> str:
    """Returns the text of a model in which the decisions are taken."""
    lines = text.splitlines(keepends=True)
    text = "".join(line for line in lines if "openDecisions" not in line)
    for what, decision in DECISIONS[profile].items():
        assert text.count(what) == 1, what
        text = text.replace(what, decision)
    return text
