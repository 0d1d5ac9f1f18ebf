"""The rules, one module for each language and topic."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.validation.rules import names, system
from jausml.validation.rules.bridge import connections as bridge_connections
from jausml.validation.rules.bridge import conversions as bridge_conversions
from jausml.validation.rules.bridge import coverage as bridge_coverage
from jausml.validation.rules.bridge import frames as bridge_frames
from jausml.validation.rules.bridge import joins as bridge_joins
from jausml.validation.rules.bridge import lists as bridge_lists
from jausml.validation.rules.bridge import maps as bridge_maps
from jausml.validation.rules.bridge import out_of_range as bridge_out_of_range
from jausml.validation.rules.bridge import ranges as bridge_ranges
from jausml.validation.rules.bridge import round_trips as bridge_round_trips
from jausml.validation.rules.bridge import tables as bridge_tables
from jausml.validation.rules.bridge import units as bridge_units
from jausml.validation.rules.bridge import vectors as bridge_vectors
from jausml.validation.rules.jaus import components as jaus_components
from jausml.validation.rules.jaus import machines as jaus_machines
from jausml.validation.rules.jaus import messages as jaus_messages
from jausml.validation.rules.jaus import services as jaus_services
from jausml.validation.rules.ros import installed as ros_installed
from jausml.validation.rules.ros import types as ros

if TYPE_CHECKING:
    from jausml.validation.rule import Rule


def all_rules() -> tuple[Rule, ...]:
    """Returns all rules, ordered by id."""
    rules = (
        *jaus_components.RULES,
        *jaus_services.RULES,
        *jaus_messages.RULES,
        *jaus_machines.RULES,
        *ros.RULES,
        *ros_installed.RULES,
        *bridge_maps.RULES,
        *bridge_frames.RULES,
        *bridge_tables.RULES,
        *bridge_joins.RULES,
        *bridge_lists.RULES,
        *bridge_vectors.RULES,
        *bridge_ranges.RULES,
        *bridge_round_trips.RULES,
        *bridge_units.RULES,
        *bridge_conversions.RULES,
        *bridge_coverage.RULES,
        *bridge_out_of_range.RULES,
        *bridge_connections.RULES,
        *names.RULES,
        *system.RULES,
    )
    return tuple(sorted(rules, key=lambda each: each.id))
