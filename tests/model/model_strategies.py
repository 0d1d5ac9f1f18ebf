"""Random models over all classes and features of some metamodels."""

from hypothesis import strategies as st

from jausml.language.metamodel import FeatureKind, ValueKind
from jausml.language.metamodel.filling import add_values, holds, link, new_object, set_value
from jausml.language.model.model import Model

MATCHING = {
    "MessageCode": "0x[0-9A-Fa-f]{4}",
    "JausAddress": r"[0-9]{1,5}\.[0-9]{1,3}\.[0-9]{1,3}",
    "ServiceVersion": r"[0-9]{1,3}\.[0-9]{1,3}",
    "Endpoint": r"[0-9A-Za-z]([0-9A-Za-z.\-]{0,9}[0-9A-Za-z])?(:[0-9]{1,5})?",
    "PackageName": r"[a-z][a-z0-9_\-]*",
}
TEXT = st.text(
    st.characters(exclude_categories=("Cs",), exclude_characters="\ufffe\uffff").filter(
        lambda c: c >= " " or c in "\t\n\r"
    ),
    max_size=8,
)


def values(feature, texts):
    """Draws values of an attribute."""
    data_type = feature.data_type
    if data_type.kind is ValueKind.STRING:
        if data_type.pattern is None:
            return texts(feature)
        return st.from_regex(MATCHING.get(data_type.name, data_type.pattern_text), fullmatch=True)
    if data_type.kind is ValueKind.ENUMERATION:
        return st.sampled_from([data_type.literals[literal] for literal in data_type.legal])
    if data_type.kind is ValueKind.BOOLEAN:
        return st.booleans()
    if data_type.kind is ValueKind.INTEGER:
        return st.integers(data_type.minimum, data_type.maximum)
    return st.floats()


def any_text(feature):  # noqa: ARG001 - the same for all features
    return TEXT


@st.composite
def models(draw, metamodels, *, texts=any_text, roots=None, model=None, others=()):
    """Draws root elements with what they own and refer to, and the model that knows their ids.

    Args:
        draw: Given by hypothesis.
        metamodels: The metamodels.
        texts: Gives the strategy for the texts of a feature.
        roots: Names of the classes of root elements, all when None.
        model: The model that knows other documents; without one, some elements have ids.
        others: Elements of these documents that may be referred to.
    """
    with_ids = model is None
    model = model or Model([], metamodels)
    made = []
    tables = [
        metaclass
        for metaclass in metamodels.classes.values()
        if not metaclass.abstract and (roots is None or metaclass.qualified_name in roots)
    ]
    elements = _Elements(draw, model, made, texts, with_ids=with_ids)
    drawn = [elements.one(draw(st.sampled_from(tables)), 3) for _ in range(draw(st.integers(1, 2)))]
    for obj in list(made):
        refer(draw, obj, [*made, *others], metamodels)
    return drawn, model


class _Elements:
    """Draws elements with what they own, and adds all of them to those that were made."""

    def __init__(self, draw, model, made, texts, *, with_ids):
        self.draw, self.model, self.made, self.texts = draw, model, made, texts
        self.with_ids = with_ids

    def one(self, table, depth):
        draw = self.draw
        obj = new_object(table)
        self.made.append(obj)
        if self.with_ids and draw(st.integers(0, 3)) == 0:
            self.model.name_by_id(obj, f"_{len(self.made)}")
        for feature in table.features.values():
            if not feature.settable or draw(st.booleans()):
                continue
            if feature.kind is FeatureKind.ATTRIBUTE and feature.many:
                drawn = st.lists(values(feature, self.texts), max_size=3, unique_by=repr)
                add_values(obj, feature, draw(drawn))
            elif feature.kind is FeatureKind.ATTRIBUTE:
                may_be_null = feature.data_type.nullable and not feature.is_id
                nulls = st.none() if may_be_null else st.nothing()
                set_value(obj, feature, draw(values(feature, self.texts) | nulls))
            elif feature.kind is FeatureKind.CONTAINMENT and depth:
                fitting = [subtype for subtype in feature.target.subtypes if not subtype.abstract]
                fitting.sort(key=lambda metaclass: metaclass.qualified_name)
                for _ in range(draw(st.integers(0, 2 if feature.many else 1))):
                    link(obj, feature, self.one(draw(st.sampled_from(fitting)), depth - 1))
        return obj


def refer(draw, obj, made, metamodels):
    """Draws what an element refers to; references with an opposite are left out."""
    for feature in metamodels.class_of(obj).features.values():
        is_plain = feature.kind is FeatureKind.CROSS_REFERENCE and feature.opposite is None
        if not is_plain or not feature.settable or draw(st.booleans()):
            continue
        kinds = feature.target.subtypes
        fitting = [candidate for candidate in made if metamodels.class_of(candidate) in kinds]
        chosen = draw(st.lists(st.sampled_from(fitting), max_size=2)) if fitting else []
        for target in chosen if feature.many else chosen[:1]:
            if not holds(obj, feature, target):
                link(obj, feature, target)
