"""Random commands on the elements of a file."""

from jausml.authoring.editing.commands import Add, Child, Move, Movement, Remove, Rename, Set
from jausml.language.metamodel import FeatureKind, ValueKind
from jausml.language.metamodel.filling import contents

MATCHING = {
    "MessageCode": "0x4F00",
    "JausAddress": "7.8.9",
    "ServiceVersion": "3.1",
    "PackageName": "some_package",
}
TEXTS = (
    "",
    "plain",
    'it\'s "quoted" & <marked>',
    "two\nlines\tand a tab",
    "Grüße, 1.5 µm",
    "a  b ",
)


class Commands:
    """Draws commands that make sense for the elements of a file as it is.

    Args:
        project: The project.
        file: The file.
        random: Where chance comes from.
    """

    def __init__(self, project, file, random):
        self.project, self.file, self.random = project, file, random
        self.model = project.model(file).model
        self.metamodels = self.model.metamodels
        self.own = list(self.model.elements_of(self.model.documents[0]))
        self.all = list(self.model.elements())

    def ref(self, obj):
        return self.project.ref(obj, self.model)

    def any(self):
        kinds = (self.set, self.set, self.add, self.add, self.remove, self.move, self.rename)
        while True:
            command = self.random.choice(kinds)()
            if command is not None:
                return command

    def set(self):
        obj = self.random.choice(self.own)
        features = [f for f in self.table(obj).features.values() if f.settable]
        features = [f for f in features if f.kind is not FeatureKind.CONTAINMENT]
        if not features:
            return None
        feature = self.random.choice(features)
        if feature.name == "name":
            return None
        return Set(self.ref(obj), feature.name, self.values(feature))

    def add(self):
        owner = self.random.choice(self.own)
        features = [f for f in self.table(owner).contained if f.many or not contents(owner, f)]
        if not features:
            return None
        feature = self.random.choice(features)
        child = self.child(feature, 2)
        position = self.random.choice([None, 0, 1]) if feature.many else None
        return Add(
            self.ref(owner), feature.name, child.kind, child.values, child.children, position
        )

    def remove(self):
        return Remove(self.ref(self.random.choice(self.own[1:] or self.own)))

    def rename(self):
        named = [element for element in self.own if "name" in self.table(element).features]
        return Rename(self.ref(self.random.choice(named)), f"name{self.random.randrange(99)}")

    def move(self):
        moving = [element for element in self.own if element.eContainer() is not None]
        if not moving:
            return None
        obj = self.random.choice(moving)
        feature = self.table(obj.eContainer()).features[obj.eContainmentFeature().name]
        owners = [obj.eContainer(), obj.eContainer()]
        owners += [e for e in self.own if feature in self.table(e).features.values()]
        owner = self.random.choice(owners)
        position = self.random.choice([None, 0, 1, 2]) if feature.many else None
        # Sometimes another one goes at the same time.
        others = [
            e for e in moving if e.eContainmentFeature().name == feature.name and e is not obj
        ]
        also = ()
        if others and self.random.random() < 0.3:
            other, there = self.random.choice(others), self.random.choice(owners)
            also = (Movement(self.ref(other), self.ref(there), feature.name, position),)
        return Move(self.ref(obj), self.ref(owner), feature.name, position, also)

    def child(self, feature, depth):
        kinds = [subtype for subtype in feature.target.subtypes if not subtype.abstract]
        table = self.random.choice(sorted(kinds, key=lambda kind: kind.qualified_name))
        values = {}
        children = []
        for structural_feature in table.features.values():
            if not structural_feature.settable:
                continue
            if structural_feature.kind is FeatureKind.CONTAINMENT:
                if depth and (structural_feature.lower or self.random.random() < 0.2):
                    children.append(self.child(structural_feature, depth - 1))
            elif structural_feature.lower or self.random.random() < 0.3:
                values[structural_feature.name] = self.values(structural_feature)
        return Child(feature.name, table.qualified_name, values, tuple(children))

    def values(self, feature):
        count = self.random.choice([0, 1, 1, 1, 2, 3]) if feature.many else 1
        if feature.kind is FeatureKind.ATTRIBUTE:
            found = [self.literal(feature.data_type) for _ in range(count)]
        else:
            fitting = [e for e in self.all if self.table(e) in feature.target.subtypes]
            found = [self.ref(self.random.choice(fitting)) for _ in range(count) if fitting]
        return () if self.random.random() < 0.1 else tuple(found)

    def literal(self, data_type):
        if data_type.kind is ValueKind.ENUMERATION:
            return self.random.choice(data_type.legal)
        if data_type.kind is ValueKind.BOOLEAN:
            return self.random.choice(["true", "false"])
        if data_type.kind is ValueKind.INTEGER:
            least = max(data_type.minimum, -1000)
            return str(self.random.randint(least, min(data_type.maximum, least + 2000)))
        if data_type.kind is ValueKind.REAL:
            return self.random.choice(["0", "1.5", "-2E-9", "1e9", "Infinity", "NaN"])
        if data_type.pattern is not None:
            return MATCHING.get(data_type.name, "x")
        return self.random.choice(TEXTS)

    def table(self, obj):
        return self.metamodels.class_of(obj)
