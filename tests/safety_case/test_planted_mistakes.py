"""A bar against evidence that is green by silence: each planted mistake is noticed by who must."""

from functools import cache
from pathlib import Path

import pytest
from for_each import for_each
from planted import FOR_PROOFS, PLANTED, UNKNOWABLE

from jausml.generation.errors import NoSystemError
from jausml.generation.native import compiler
from jausml.generation.target import system_of
from jausml.language.model.reading.library_cache import LibraryCache
from jausml.language.project import OneDocument
from jausml.language.validation.engine import check
from jausml.model_checking.checking import check_system
from jausml.proving.results import PROOF_RULES, with_proofs
from jausml.proving.round_trips import round_trips
from jausml.proving.running import Settings, prove
from jausml.safety_case.argument import ASSUMPTIONS, BY_RULES, safety_case

GUARDS = ("jausml/language/validation", "jausml/model_checking", "jausml/safety_case")

FERRY = Path(__file__).with_name("ferry.ros2jaus")
VERBS = ("validate", "case", "model-check")
GUARDING = [*list(PLANTED)[::4], "a trap with a door into itself"]


@cache
def library():
    return LibraryCache()


def report_of(changes=()):
    text = FERRY.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text, f"{old} is not in the model"
        text = text.replace(old, new)
    return check(OneDocument(FERRY, text).read(library()))


def noticing(changes=()):
    """Who notices something in the model, and what."""
    report = report_of(changes)
    found = {"validate": [f"{e.rule} {e.message}" for e in report.diagnostics]}
    cases = safety_case(report, (), ()).goals
    found["case"] = [f"{case.id}: {case.standing}" for case in cases if case.standing != BY_RULES]
    try:
        products = check_system(system_of(report.model), 20_000, lambda: False)
    except NoSystemError:
        products = []
    found["model-check"] = [
        f"{example.rule} {example.message}" for product in products for example in product.found
    ]
    return {verb: told for verb, told in found.items() if told}


def test_nothing_is_noticed_without_a_mistake():
    assert noticing() == {}
    goals = safety_case(report_of(), (), ()).goals
    assert len(goals) > 10
    assert not any(goal.supported for goal in goals)


@for_each("name", GUARDING)
def test_a_planted_mistake_is_noticed(name):
    holds_to(name)


@pytest.mark.slow
@for_each("name", [mistake for mistake in PLANTED if mistake not in GUARDING])
def test_each_other_planted_mistake_is_noticed(name):
    holds_to(name)


def holds_to(name):
    verbs, changes = PLANTED[name]
    found = noticing(changes)
    assert tuple(verb for verb in VERBS if verb in found) == tuple(
        verb for verb in VERBS if verb in verbs
    ), found


@for_each("name", UNKNOWABLE)
def test_what_no_check_can_know_is_an_assumption_of_the_case(name):
    word, changes = UNKNOWABLE[name]
    assert noticing(changes) == {}
    assert any(word in assumption for assumption in ASSUMPTIONS)


@pytest.mark.needs("compiler")
@pytest.mark.slow
def test_a_proof_finds_what_does_not_come_back():
    report = report_of(FOR_PROOFS)
    trips = [round_trip for round_trip in round_trips(report.model) if round_trip.name == "drive"]
    proved = list(prove(report.model, trips, Settings(str(compiler()), 0.01, 1)))
    judged = with_proofs(report, trips, proved)
    assert [diagnostic.rule for diagnostic in judged.diagnostics if diagnostic.rule in PROOF_RULES]
