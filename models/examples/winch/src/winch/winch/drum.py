"""A drum with a rope and a load: what the winch turns, as far as the example needs it."""

from __future__ import annotations

ROPE = 2.0
"""Length of the rope in metres."""

LOAD = 5000.0
"""Force of the load in newtons."""

BREAKING_SPEED = 1.5
"""Speed in metres per second above which the sling of the load gives way."""


class Drum:
    """A drum that turns at once as it is told.

    Attributes:
        length: Rope that is out, in metres.
        speed: Speed of the rope in metres per second, positive when it is paid out.
        tension: Force on the rope in newtons.
        is_braked: Whether the brake holds the drum.
    """

    def __init__(self) -> None:
        self.length = 0.0
        self.speed = 0.0
        self.tension = LOAD
        self.is_braked = True

    @property
    def is_at_end(self) -> bool:
        """Whether the rope leads no further in the direction in which it moves."""
        return self.leads_beyond(self.speed)

    @property
    def has_load(self) -> bool:
        """Whether the load hangs on the rope."""
        return self.tension > 0

    def leads_beyond(self, speed: float) -> bool:
        """Returns whether a speed leads beyond an end of the rope.

        Args:
            speed: Metres per second, positive when the rope is paid out.
        """
        return (speed > 0 and self.length >= ROPE) or (speed < 0 and self.length <= 0)

    def turn(self, speed: float) -> None:
        """Turns at a speed in metres per second, unless the brake holds the drum."""
        if not self.is_braked:
            self.speed = speed

    def stop(self) -> None:
        """Stops the motor."""
        self.speed = 0.0

    def brake(self) -> None:
        """Engages the brake."""
        self.speed = 0.0
        self.is_braked = True

    def release(self) -> None:
        """Releases the brake."""
        self.is_braked = False

    def step(self, duration: float) -> None:
        """Moves the rope.

        Args:
            duration: Seconds.
        """
        self.length = min(ROPE, max(0.0, self.length + self.speed * duration))
        if abs(self.speed) > BREAKING_SPEED:
            self.tension = 0.0
