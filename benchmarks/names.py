"""What data and page call the things that are measured."""

from __future__ import annotations

RELAY, FLOOR, COMPILED = "relay", "floor", "compiled"
GENERATED, TYPED, GENERIC = "generated", "typed", "generic"
VARIANTS = (RELAY, FLOOR, COMPILED, GENERATED, TYPED, GENERIC)
"""The bridges that stand side by side."""

FLOORS = (RELAY, FLOOR)
"""Those that only forward bytes."""

BRIDGES = (COMPILED, GENERATED, TYPED, GENERIC)

JUDGED = (COMPILED, GENERATED)
"""Those that users run, with a compiler and without."""

WAYS = ("up", "down")
"""From JAUS to ROS, and from ROS to JAUS."""

ALL_WAYS = (*WAYS, "both")
WAY_NAMES = {"up": "JAUS to ROS", "down": "ROS to JAUS", "both": "both ways at once"}

LIGHT = "light"
FORMS = (COMPILED, LIGHT, TYPED, GENERIC)
"""Forms of a translation."""

KINDS = {
    "point": ("point", "stamped point"),
    "twist": ("twist", "twist"),
    "odometry": ("odometry", "odometry, strings"),
    "scan": ("scan", "scan of 360"),
    "grid": ("grid", "grid of 40 kB"),
    "path": ("path", "path of 100"),
    "large": ("grid", "60 kB"),
}
"""Kinds of messages: the map, and how the page calls it."""

READY_MAPS = {
    "velocity_state": ("odometry", "ReportVelocityState, Odometry"),
    "laser_scan": ("scan", "ReportRangeSensorData, scan of 360"),
    "cost_map": ("grid", "ReportCostMap2D, grid of 40 kB"),
    "planned_local_path": ("path", "ReportPath, path of 100"),
}
"""Ready maps of the library: the kind whose ROS message they are given, and what the page says."""

SMALL = ("point", "twist", "odometry")
"""Those that count as small messages."""
