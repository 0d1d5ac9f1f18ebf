"""The modules of the runtime that generated code imports names from."""

API_VERSION = (1, 0)
"""API of the runtime that generated code is written for."""

FACE = "jausml_runtime"
"""Components, bridges, and what they are made and told of."""
MESSAGES = f"{FACE}.messages"
"""Messages of the core services."""
CONVERSIONS = f"{FACE}.conversions"
"""Conversions of values, and the values that they know."""
ARITHMETIC = f"{CONVERSIONS}.arithmetic"
"""Functions of expressions."""
WIRE = f"{FACE}.wire"
"""What classes of messages are made of."""
