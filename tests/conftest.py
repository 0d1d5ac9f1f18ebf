"""What holds for all tests."""

from __future__ import annotations

from hypothesis import settings

# No test judges the clock: an example that imports something for the first time may take long.
settings.register_profile("jausml", settings(), deadline=None)
settings.load_profile("jausml")
