"""What mypy is told of the metamodels, beside what pyecore really does."""

import ast
import importlib
import importlib.util
import shutil
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from for_each import for_each
from scripts import ran, succeeded

from jausml.language.metamodel import ValueKind, load_jaus_metamodel, load_metamodels
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import new_object
from jausml.language.model import read_models
from jausml.language.semantics.subject import Subject

GUARDS = ("metamodels", "tools/build_model_types.py", "tools/templates")

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "jausml" / "language" / "metamodel" / "classes"
METAMODELS = load_metamodels()
LANGUAGES = ("jaus", "ros", "bridge", "system")
CLASSES = sorted(METAMODELS.classes)
PYTHON_TYPES: dict[str, Any] = {"str": str, "bool": bool, "int": int, "float": float}


def tool() -> Any:
    specification = importlib.util.spec_from_file_location(
        "build_model_types", ROOT / "tools" / "build_model_types.py"
    )
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    sys.modules[module.__name__] = module
    specification.loader.exec_module(module)
    return module


@cache
def stub(language: str) -> dict[str, dict[str, str]]:
    """Returns the annotations of a stub by class."""
    text = (FOLDER / f"{language}.pyi").read_text(encoding="utf-8")
    found: dict[str, dict[str, str]] = {}
    for node in ast.parse(text).body:
        if isinstance(node, ast.ClassDef):
            found[node.name] = {
                statement.target.id: ast.unparse(statement.annotation)
                for statement in node.body
                if isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name)
            }
    return found


def python_class(qualified: str) -> Any:
    language, name = qualified.split(".")
    return getattr(importlib.import_module(f"jausml.language.metamodel.classes.{language}"), name)


def test_the_stubs_are_those_that_the_tool_writes(tmp_path):
    written = tool().build(tmp_path)
    assert [path.name for path in written] == [f"{name}.pyi" for name in LANGUAGES]
    for path in written:
        assert path.read_text("utf-8") == (FOLDER / path.name).read_text("utf-8"), path.name


@for_each("qualified", CLASSES)
def test_a_class_is_the_one_that_elements_are_made_of(qualified):
    table = METAMODELS.classes[qualified]
    kind = python_class(qualified)
    assert issubclass(kind, EObject)
    assert kind.eClass is table.eclass
    for other in METAMODELS.classes.values():
        is_super = other in table.supertypes
        assert issubclass(kind, python_class(other.qualified_name)) is is_super, other
    if not table.abstract:
        assert type(new_object(table)) is kind


@for_each("qualified", CLASSES)
def test_a_stub_declares_the_features_of_its_class(qualified):
    language, name = qualified.split(".")
    own = METAMODELS.classes[qualified].eclass.eStructuralFeatures
    assert list(stub(language)[name]) == [feature.name for feature in own]


@for_each("qualified", [name for name in CLASSES if not METAMODELS.classes[name].abstract])
def test_a_new_element_has_the_values_that_its_stub_promises(qualified):
    table = METAMODELS.classes[qualified]
    element = new_object(table)
    for supertype in table.supertypes:
        for name, annotation in stub(supertype.package.name)[supertype.name].items():
            value = getattr(element, name)
            feature = table.features[name]
            plain = annotation.removesuffix(" | None")
            if annotation.startswith("abc.Sequence["):
                assert len(value) == 0
                assert value[:] == []
            elif value is None:
                assert annotation != plain or feature.lower > 0, name
            elif feature.data_type is not None and feature.data_type.kind is ValueKind.ENUMERATION:
                literals = stub(supertype.package.name)[plain]["name"]
                assert repr(value.name) in literals, name
            else:
                assert type(value) is PYTHON_TYPES[plain], name


def test_elements_of_a_model_are_owned_by_what_the_stubs_say():
    example = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
    view = tool().ClassView
    seen = 0
    for element in read_models([example]).model.elements():
        owner = element.eContainer()
        if owner is not None:
            said = view(METAMODELS.class_of(element), METAMODELS).all_owners
            assert METAMODELS.class_of(owner).supertypes.intersection(said)
            seen += 1
    assert seen > 1000


def test_an_abstract_class_and_a_class_of_another_language_have_their_instances():
    assert isinstance(new_object(METAMODELS.classes["jaus.Array"]), jaus.Field)
    made = new_object(METAMODELS.classes["bridge.Bridge"])
    assert isinstance(made, bridge.Bridge)
    assert isinstance(made, jaus.Component)
    assert not isinstance(made, ros.Node)


def test_the_jaus_metamodel_alone_has_the_same_classes():
    alone = load_jaus_metamodel().classes["jaus.Record"]
    assert isinstance(new_object(alone), jaus.Record)


def test_instances_are_of_the_class_that_is_asked_for():
    said = Subject.instances.__annotations__
    assert (said["kind"], said["return"]) == ("type[ElementT]", "list[ElementT]")


def test_an_unknown_class_is_an_attribute_error():
    with pytest.raises(AttributeError, match="the jaus language has no class 'FixedFeld'"):
        _ = jaus.FixedFeld


SNIPPET = """
from jausml.language.metamodel.classes import jaus

def names(service: jaus.Service, field: jaus.Field) -> None:
    for message in service.inputs:
        message.boddy
    if isinstance(field, jaus.FixedField):
        field.scale.lower
        field.type.name == "uint9"
        field.units = 3
    field.scale
    jaus.FixedFeld
"""


@pytest.mark.slow
def test_mypy_finds_what_the_metamodels_do_not_have(tmp_path):
    """Of the stubs alone: to read all that the packages around them import takes seconds."""
    (tmp_path / "snippet.py").write_text(SNIPPET)
    copy = tmp_path / FOLDER.relative_to(ROOT)
    shutil.copytree(FOLDER, copy, ignore=shutil.ignore_patterns("*.py"))
    for package in (copy, *copy.parents[:3]):
        (package / "__init__.pyi").touch()
    done = ran([sys.executable, "-m", "mypy", "--strict", "snippet.py"], cwd=tmp_path)
    found = [line.split(": error: ")[1] for line in done.stdout.splitlines() if ": error: " in line]
    assert found == [
        '"MessageDef" has no attribute "boddy"; maybe "body"?  [attr-defined]',
        'Item "None" of "ScaleRange | None" has no attribute "lower"  [union-attr]',
        "Non-overlapping equality check (left operand type: \"Literal['uint8', 'int8',"
        " 'uint16', 'int16', 'uint32', 'int32', 'uint64', 'int64', 'float32', 'float64']\","
        " right operand type: \"Literal['uint9']\")  [comparison-overlap]",
        'Incompatible types in assignment (expression has type "int",'
        ' variable has type "str | None")  [assignment]',
        '"Field" has no attribute "scale"  [attr-defined]',
        'Module has no attribute "FixedFeld"; maybe "FixedField"?  [attr-defined]',
    ]


# -- several threads at once -----------------------------------------------------------------------


PROGRAM = """
import threading
from jausml.language.metamodel import load_metamodels

found, together = [], threading.Barrier(4)

def load():
    together.wait()
    found.append(load_metamodels())

threads = [threading.Thread(target=load) for _ in range(4)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(len(found), len(set(map(id, found))))
"""


def test_metamodels_are_loaded_once():
    done = succeeded([sys.executable, "-c", PROGRAM], timeout=60)
    assert done.stdout.split() == ["4", "1"]
