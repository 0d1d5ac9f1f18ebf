"""The members of a ROS message that corresponds to a wrench effort as a whole (AS6009)."""

EFFORTS = [
    f"{kind}_{motion}_effort_{axis}"
    for kind in ("propulsive", "resistive")
    for motion in ("linear", "rotational")
    for axis in "xyz"
]
