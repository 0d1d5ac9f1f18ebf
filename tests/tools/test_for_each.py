"""Values of one test: each is tried, and each that fails is named."""

import pytest
from for_each import for_each

pytest_plugins = ["pytester"]
TEST = """
import pytest
from for_each import for_each

@for_each(("number", "word"), [(1, "a"), (2, "b"), (3, "c"), (4, "d")], ids=str, shards={shards})
def test_small(number, word, tmp_path):
    assert tmp_path.is_dir()
    assert number % 2 == 1, word
"""


@pytest.mark.parametrize(("shards", "tests", "failed"), [(1, 1, 1), (2, 2, 2), (3, 3, 2)])
def test_all_that_fail_are_named(pytester, shards, tests, failed):
    pytester.makepyfile(TEST.format(shards=shards))
    done = pytester.runpytest_inprocess("-p", "no:xdist", "-rf")
    done.assert_outcomes(passed=tests - failed, failed=failed + 2)
    lines = "\n".join(done.outlines)
    assert "SUBFAILED[(2, 'b')]" in lines
    assert "SUBFAILED[(4, 'd')]" in lines
    assert "(3, 'c')" not in lines


@pytest.mark.parametrize(("chosen", "tests"), [("not slow", 1), ("slow", 3)])
def test_of_a_slow_one_the_first_shard_guards(pytester, chosen, tests):
    pytester.makepyprojecttoml('[tool.pytest.ini_options]\nmarkers = ["slow"]\n')
    pytester.makepyfile("""
        from for_each import for_each

        @for_each("number", range(8), shards=4, slow=True, rest=1)
        def test_small(number):
            assert number >= 0
    """)
    done = pytester.runpytest_inprocess("-p", "no:xdist", "-m", chosen)
    done.assert_outcomes(passed=tests, deselected=4 - tests)


def test_a_test_of_nothing_is_refused():
    with pytest.raises(AssertionError, match="would test nothing"):
        for_each("value", [])(print)


def test_values_may_be_read_when_the_test_runs(pytester):
    pytester.makepyfile("""
        from for_each import for_each
        from hypothesis import given, strategies as st

        def numbers():
            return (2, 3)

        def nothing():
            return ()

        @for_each("number", numbers)
        @given(other=st.integers())
        def test_numbers(number, other):
            assert number * other % 2 == 0

        @for_each("number", nothing)
        def test_nothing(number):
            pass
    """)
    done = pytester.runpytest_inprocess("-p", "no:xdist", "-rf")
    done.assert_outcomes(failed=1 + 1 + 1)
    lines = "\n".join(done.outlines)
    assert "SUBFAILED[3]" in lines
    assert "SUBFAILED[2]" not in lines
    assert "test_nothing tests nothing" in lines
