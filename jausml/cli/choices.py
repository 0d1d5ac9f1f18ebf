"""What options offer, without the modules that know more of it: these take long to load.

Tests compare.
"""

from __future__ import annotations

TEXT_OR_JSON = ("text", "json")
"""For people, and for programs."""

SHELLS = ("bash", "zsh", "fish")
"""Shells that are completed for."""

COMPLETION = "_JAUSML_COMPLETE"
"""The variable by which a shell asks for completions; click makes its name of the program's."""

REPORT_FORMATS = ("text", "json", "junit", "sarif", "github")
"""`jausml.language.validation.formats`."""

CONFORMANCE_FORMATS = ("text", "json", "junit")
"""`jausml.live.peers.conformance.formats`."""

QUESTIONS = ("heartbeat", "identification", "status", "control")
"""`jausml.live.peers.measuring`."""

AUTHORITY = 205
"""`jausml.live.peers.console`."""

TRANSPORTS = ("judp", "jtcp", "node-manager")
INTERFACE = "127.0.0.1"
PORT = 3794
GROUP = "239.255.0.1"
"""`jausml.live.peers.network`."""
