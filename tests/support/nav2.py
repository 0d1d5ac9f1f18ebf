"""The messages of Nav2, of which there is no wheel: made once for all tests that carry them."""

import needs
import processor_time
from type_support import built

TYPES = (
    "msg/MissedWaypoint.msg",
    "action/FollowPath.action",
    "action/FollowWaypoints.action",
    "action/NavigateThroughPoses.action",
    "action/NavigateToPose.action",
)


def nav2() -> str:
    """Returns the folder for the module path; skips the test where nothing can be built."""
    needs.ask("type support")
    with processor_time.counted_to("support/nav2.py"):
        return str(built("nav2_msgs", TYPES))
