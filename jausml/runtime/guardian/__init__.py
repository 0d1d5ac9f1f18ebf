"""The guardian: a small process that sends the stops of a bridge when the bridge cannot."""
