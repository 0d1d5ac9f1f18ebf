"""Names the packages: the folders beside jausml/ become its sub-packages (see pyproject.toml)."""

from setuptools import find_packages, setup

generators = ["jausml.generators", *(f"jausml.generators.{name}" for name in find_packages("generators"))]

setup(packages=[*find_packages(include=["jausml", "jausml.*"]), *generators, "jausml.metamodels", "jausml.models"])
