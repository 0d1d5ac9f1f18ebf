"""Limits of rates, times and speeds of connections: what bridges take as parameters.

A bridge has a parameter for each of these figures, and does not start with one that is outside.
The runtime states the same (`runtime/bridge/ends/parameters.py`), as it imports nothing of the
toolchain; a test compares both.
"""

from __future__ import annotations

LONGEST_TIME = 3600.0
"""Seconds of a silence or age, or of a call without an answer."""

LONGEST_FRESHNESS = 1e9
"""Seconds in which a joined message is fresh: one that holds a state is so for ever."""

SHORTEST_TIME = 0.001
"""Seconds of a freshness of a join, and of a call."""

LEAST_RATE = 0.02
"""Hertz of an event or a query; the step on the wire is 1092 / 65535 Hz (AS5710)."""

MAXIMUM_RATE = 1092.0
"""Largest rate of a periodic event in Hz (AS5710, CreateEvent, field RequestedPeriodicRate)."""

LEAST_PACE = 0.001
"""Hertz above which messages are thinned out, besides 0."""

GREATEST_SPEED = 327.67
"""Metres per second that ExecuteList can say (AS6009)."""

GREATEST_DECIMATION = 1_000_000
"""Messages of which one passes."""
