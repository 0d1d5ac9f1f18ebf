"""Packages: the code as found, and the data folders that pyproject.toml places in it."""

from setuptools import find_packages, setup

setup(
    packages=[
        *find_packages(include=["jausml", "jausml.*"]),
        *find_packages("generators"),
        "jausml.metamodels",
        "jausml.models",
    ]
)
