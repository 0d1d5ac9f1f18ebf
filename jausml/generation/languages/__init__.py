"""What the engine knows of the languages that it writes."""
