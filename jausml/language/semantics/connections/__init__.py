"""Connections: their messages, peers, rates and stops."""
