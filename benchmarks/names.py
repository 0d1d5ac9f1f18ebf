"""What data and page call the things that are measured."""

from __future__ import annotations

FLOOR, COMPILED, GENERATED = "floor", "compiled", "generated"
VARIANTS = (FLOOR, COMPILED, GENERATED)
"""What stands side by side: a program that only forwards bytes, and the bridges that users run,
with a compiler and without."""

WAYS = ("up", "down")
"""From JAUS to ROS, and from ROS to JAUS."""

WAY_NAMES = {"up": "JAUS to ROS", "down": "ROS to JAUS"}

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

SMALL = ("point", "twist", "odometry")
"""Those that count as small messages."""

PACKETS = "large"
"""That which takes more packets than a peer takes at once."""
