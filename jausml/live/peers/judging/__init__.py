"""Judge of competitions: published tasks with points, taken by a component over the wire."""
