"""The guardian: a small process beside a bridge, which says its stops when the bridge cannot."""
