"""What was found, for code scanning: located at the connection or machine in the model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.validation.formats import sarif
from jausml.language.validation.rule import Report
from jausml.language.validation.rules import PRODUCT_RULES
from jausml.model_checking.checking import diagnostic_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.model import Model
    from jausml.model_checking.checking import Outcome


def render(outcomes: Sequence[Outcome], model: Model) -> str:
    """Returns a SARIF log of one run."""
    files = tuple(document.display for document in model.documents if document.given)
    found = [diagnostic_of(each.subject, one, model) for each in outcomes for one in each.found]
    aside = tuple(one for each in outcomes for one in each.allowed)
    return sarif.render(Report(model, files, tuple(found), aside, PRODUCT_RULES))
