"""Which bridge carries which connections: what that costs, and how it costs least."""
