"""What a release must have, without building one."""

from importlib import metadata

import pytest
from for_each import for_each
from release_check import PAGES, USED, NotReleasableError, check_page, check_version, lowest

CHANGELOG = "# Changelog\n\n## [Unreleased]\n\n## [1.2.3] - 2026-01-02\n"


def test_a_version_with_a_day_and_without_a_tag_is_free():
    check_version("1.2.3", CHANGELOG, ["v1.2.2"])


@for_each(
    ("version", "tags", "said"),
    [
        ("1.2", [], "not of the form"),
        ("1.2.3.dev1", [], "not of the form"),
        ("1.2.3", ["v1.2.3"], "raise __version__"),
        ("1.3.0", [], "no heading `## [1.3.0] - YYYY-MM-DD`"),
    ],
)
def test_a_version_is_refused(version, tags, said):
    with pytest.raises(NotReleasableError) as caught:
        check_version(version, CHANGELOG, tags)
    assert said in str(caught.value)


def test_lowest_versions_are_those_of_the_bounds():
    requirements = ["a>=1.2,<2", "b==3", 'c>=1; extra == "dev"', "d[x]<9,>=4"]
    assert lowest(requirements) == ["a==1.2", "b==3", "d==4"]
    assert lowest([*requirements, *requirements], ["dev"]) == ["a==1.2", "b==3", "c==1", "d==4"]


def test_a_requirement_without_a_lower_bound_is_refused():
    with pytest.raises(NotReleasableError, match="a<2 has no lower bound"):
        lowest(["a<2"])


def test_each_dependency_of_the_project_has_a_lowest_version():
    found = lowest(metadata.requires("jausml"), USED)
    assert {"pyecore==0.15.2", "textual==6.2", "mcap==1.6", "uvicorn==0.53"} <= set(found)


def test_a_wheel_has_its_pages():
    page = [f"{folder}{file}" for folder in PAGES for file in ("index.html", "assets/index-abc.js")]
    check_page([*page, "jausml/__init__.py"])
    for missing in page:
        with pytest.raises(NotReleasableError, match="no page"):
            check_page([file_name for file_name in page if file_name != missing])
