"""Rules about bridges, connections and attribute maps."""

from jausml.validation.rules.bridge import (
    connections,
    conversions,
    coverage,
    frames,
    freshness,
    joins,
    lists,
    maps,
    out_of_range,
    ranges,
    round_trips,
    tables,
    units,
    vectors,
)

MODULES = (
    connections,
    conversions,
    coverage,
    frames,
    freshness,
    joins,
    lists,
    maps,
    out_of_range,
    ranges,
    round_trips,
    tables,
    units,
    vectors,
)
