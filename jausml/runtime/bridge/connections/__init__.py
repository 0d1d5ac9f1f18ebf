"""Connections of topics and messages."""
