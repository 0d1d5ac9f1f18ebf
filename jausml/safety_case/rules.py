"""The rules of safety cases that are checked in, by which `jausml case` says what has changed."""

from __future__ import annotations

from collections.abc import Mapping

from jausml.language.model.diagnostics import RuleInfo

LOST, STALE, ANSWER, OLD = (f"JML{number}" for number in range(941, 945))

CASE_RULES: Mapping[str, RuleInfo] = {
    LOST: RuleInfo(
        "case: evidence that is lost",
        "A file of evidence that a safety case names is not there any more, cannot be read, or "
        "is another one than it was. Good: the file again, or a case that is made anew.",
    ),
    STALE: RuleInfo(
        "case: evidence of another model",
        "A piece of evidence was found of another version of the model, so it says nothing of "
        "this one. Good: prove, test and run again, and make the case anew.",
    ),
    ANSWER: RuleInfo(
        "case: goal that has lost its answer",
        "The model does nothing about the hazard any more, or evidence speaks against it. "
        "Good: give the model its answer again, or have a new case reviewed.",
    ),
    OLD: RuleInfo(
        "case: out of date",
        "The model, jausml or what was found differs from the safety case that is checked in. "
        "Good: make it anew by `jausml case -o`, and review what has changed.",
    ),
}
