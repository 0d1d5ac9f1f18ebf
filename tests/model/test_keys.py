"""References and keys: exact, and lasting."""

from pathlib import Path

from for_each import for_each

from jausml.language.model import read_models
from jausml.language.model.library import LIBRARY_URI
from jausml.language.model.refs import LIBRARY, Keys, find, ref_of
from jausml.language.text.notation import NOTATIONS

MODELS = Path(__file__).resolve().parents[2] / "models"
CAR = MODELS / "catvehicle" / "catvehicle.xmi"
SHIPPED = sorted(path for path in MODELS.rglob("*") if path.suffix in (".xmi", ".ros2jaus"))


def read(path):
    return read_models([path], notations=NOTATIONS).model


@for_each("path", SHIPPED, ids=lambda path: path.stem, shards=18, slow=True)
def test_each_element_has_a_key_and_a_reference_of_its_own(path):
    model = read(path)
    keys = Keys(model)
    elements = list(model.elements())
    for names in (
        [keys.of(element) for element in elements],
        [ref_of(element, model, MODELS) for element in elements],
    ):
        assert len(names) == len(set(names))
        assert all(names)
    assert all(
        find(ref_of(element, model, MODELS), model, MODELS) is element for element in elements
    )


def test_a_reference_names_the_file_as_seen_from_the_folder():
    model = read(CAR)
    (logger,) = (
        element for element in model.elements() if getattr(element, "name", "") == "logger"
    )
    fragment = model.fragment(logger)
    assert ref_of(logger, model, MODELS) == f"catvehicle/catvehicle.xmi#{fragment}"
    assert ref_of(logger, model, MODELS / "library") == f"{CAR.as_posix()}#{fragment}"
    message = next(element for element in model.elements() if element.eClass.name == "MessageDef")
    assert ref_of(message, model, MODELS).startswith(f"{LIBRARY}jaus/")


def test_a_key_stays_when_elements_are_added_before(tmp_path):
    before = {}
    text = CAR.read_text(encoding="utf-8").replace("../library/", LIBRARY_URI)
    path = tmp_path / "car.xmi"
    for added in ("", '  <nodes name="first"/>\n  <nodes/>\n'):
        at = text.index("  <nodes ")
        path.write_text(text[:at] + added + text[at:], encoding="utf-8")
        model = read(path)
        keys = Keys(model)
        named = {
            keys.of(element): element.name
            for element in model.elements(library=False)
            if getattr(element, "name", None)
        }
        assert before.items() <= named.items()
        before = named
    assert "node:logger" in before
    assert "bridge:bridge" in before


def test_names_that_are_not_distinct_are_numbered(tmp_path):
    path = tmp_path / "car.xmi"
    path.write_text(
        CAR.read_text(encoding="utf-8")
        .replace("../library/", LIBRARY_URI)
        .replace("  <nodes ", '  <nodes name="a/b%[1]"/>\n  <nodes name="vehicle"/>\n  <nodes ', 1)
        .replace("  <nodes ", '  <nodes name="vehicle"/>\n  <nodes ', 1),
        encoding="utf-8",
    )
    model = read(path)
    keys = Keys(model)
    found = [keys.of(element) for element in model.elements(library=False)]
    assert {"component:vehicle", "node:vehicle", "node:vehicle[1]"} <= set(found)
    assert "node:a%2Fb%25%5B1%5D" in found
    assert len(found) == len(set(found))
