"""Guards are read by a small grammar, whatever text stands in a model."""

from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jausml.language.attributes.guards import (
    LONGEST,
    MOST_ALTERNATIVES,
    AllOf,
    AnyOf,
    Condition,
    GuardError,
    Negation,
    alternatives,
    conditions,
    parse_guard,
)

A, B, C = Condition("a"), Condition("b"), Condition("c")


@pytest.mark.parametrize(
    ("text", "guard"),
    [
        (None, None),
        ("  ", None),
        ("a", A),
        (" a ( transportData ) ", A),
        ("service.a(msg, 'X', 1)", A),
        ("!a", Negation(A)),
        ("! !a", Negation(Negation(A))),
        ("a && b && c", AllOf((A, B, C))),
        ("a || b && c", AnyOf((A, AllOf((B, C))))),
        ("(a || b) && c", AllOf((AnyOf((A, B)), C))),
        ("!(a&&b)||c", AnyOf((Negation(AllOf((A, B))), C))),
    ],
)
def test_guards_are_read(text, guard):
    assert parse_guard(text) == guard


@pytest.mark.parametrize(
    ("text", "column"),
    [
        ("a &&", 5),
        ("&& a", 1),
        ("a b", 3),
        ("a & b", 3),
        ("(a", 1),
        ("a)", 2),
        ("a > 1", 3),
        ("a(b(c))", 2),
        ("a; import os", 2),
        ("é", 1),
        ("1a", 1),
        ("()", 2),
    ],
)
def test_other_texts_are_refused_with_the_column(text, column):
    with pytest.raises(GuardError) as caught:
        parse_guard(text)
    assert caught.value.column == column
    assert f"column {column}" in str(caught.value)


def test_bounds_hold():
    with pytest.raises(GuardError, match="nested too deeply"):
        parse_guard("(" * 400 + "a" + ")" * 400)
    with pytest.raises(GuardError, match="characters"):
        parse_guard("a" * (LONGEST + 1))


@pytest.mark.slow
@settings(max_examples=max(1, settings().max_examples // 3))
@given(st.text(max_size=60) | st.text(alphabet="ab.!&|() ,'_1", max_size=40))
def test_no_text_does_harm(text):
    try:
        guard, column = parse_guard(text), 1
    except GuardError as error:
        guard, column = None, error.column
    assert 1 <= column <= len(text) + 1
    assert all(name.isascii() and name.isidentifier() for name in conditions(guard))


_GUARDS = st.recursive(
    st.sampled_from([A, B, C]),
    lambda inner: st.one_of(
        st.builds(Negation, inner),
        st.lists(inner, min_size=2, max_size=3).map(lambda found: AllOf(tuple(found))),
        st.lists(inner, min_size=2, max_size=3).map(lambda found: AnyOf(tuple(found))),
    ),
    max_leaves=8,
)


def written(guard):
    if isinstance(guard, Condition):
        return guard.name
    if isinstance(guard, Negation):
        return f"!({written(guard.operand)})"
    sign = "&&" if isinstance(guard, AllOf) else "||"
    return sign.join(f"({written(operand)})" for operand in guard.operands)


@given(_GUARDS)
def test_what_is_written_is_read(guard):
    assert parse_guard(written(guard)) == guard


def holds(guard, facts):
    if isinstance(guard, Condition):
        return facts[guard.name]
    if isinstance(guard, Negation):
        return not holds(guard.operand, facts)
    joined = all if isinstance(guard, AllOf) else any
    return joined([holds(operand, facts) for operand in guard.operands])


@given(_GUARDS)
def test_alternatives_hold_when_the_guard_holds(guard):
    found = alternatives(guard)
    assert found
    for values in product((False, True), repeat=3):
        facts = dict(zip("abc", values, strict=True))
        by_alternatives = any(
            all(facts[e.name] is so for e, so in alternative) for alternative in found
        )
        assert by_alternatives == holds(guard, facts)


def test_alternatives_are_bounded():
    number = MOST_ALTERNATIVES.bit_length()
    choice = " && ".join(f"(a{n} || b{n})" for n in range(number))
    assert alternatives(parse_guard(choice)) is None
    assert alternatives(parse_guard(f"!({choice})")) is not None
    assert alternatives(parse_guard(f"!(!({choice}))")) is None
