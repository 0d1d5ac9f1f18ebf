"""Paths that lead to one another, counted without comparing each with each."""

import pytest

from jausml_generators.bridge.checks.ends import Paths

PATHS = ["pose", "pose.position.x", "pose.position.x", "poses", "covariance[3]", "covariance[30]"]


@pytest.mark.parametrize(
    ("path", "count"),
    [
        ("pose", 3),
        ("pose.position", 3),
        ("pose.position.x", 3),
        ("pose.position.x.y", 3),
        ("pose.orientation", 1),
        ("poses", 1),
        ("pos", 0),
        ("covariance", 2),
        ("covariance[3]", 1),
        ("covariance[4]", 0),
    ],
)
def test_paths_overlap_with_what_they_are_in_and_what_is_in_them(path, count):
    assert Paths(PATHS).overlapping(path) == count
