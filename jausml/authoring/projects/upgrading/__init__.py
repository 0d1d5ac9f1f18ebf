"""Upgrades: models of an older version of a metamodel become models of the present one."""
