"""Transports: how messages reach other processes (AS5669A)."""
