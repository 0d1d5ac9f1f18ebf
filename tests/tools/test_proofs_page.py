"""The page of proofs has each map, and says of each what was found."""

import re

import build_proofs
import pytest

from jausml.language.metamodel.classes import bridge
from jausml.language.model.library import library_paths
from jausml.language.validation.engine import check_project
from jausml.proving.results import FieldResult, MapResult, outcome_text

GUARDS = ("tools/build_proofs.py", "models/library/mappings")


@pytest.mark.slow
@pytest.mark.needs("compiler")
def test_a_ready_map_makes_a_page(tmp_path):
    page = tmp_path / "made" / "proofs.md"
    (maps,) = (path for path in library_paths("mappings") if path.stem == "cost_map_2d")
    build_proofs.main(["--jobs", "1", "--page", str(page), str(maps)])
    text = page.read_text(encoding="utf-8")
    model = check_project([str(maps)]).model
    names = [str(attribute_map.name) for attribute_map in model.instances(bridge.AttributeMap)]
    assert re.findall(r"^### (\w+)$", text, re.MULTILINE) == names
    assert text.startswith(build_proofs.HEAD)
    assert "- left to Python: cost_map_to_ros: " in text


def test_what_was_found_of_a_map_is_told():
    def number(path: str, unchanged: int, *, has_back: bool) -> FieldResult:
        made = FieldResult("JAUS", path, "", 8, 1.0, (0.0, 255.0), 256, 256, has_back)
        made.unchanged, made.changed = unchanged, 256 - unchanged
        return made

    fields = [
        number("Sound", 256, has_back=True),
        number("Lossy", 200, has_back=True),
        number("Only", 256, has_back=False),
    ]
    tried = MapResult("tried", "SetSmall", "Twist", fields)
    left = MapResult("left", "SetOther", "Bool", remarks=["left to Python: to_ros: lists"])
    page = build_proofs.page(
        [tried, left],
        {"tried": "mappings.one", "left": "mappings.two"},
        {"tried": ["JML922 tried: JAUS Lossy drifts"]},
    )
    assert page.count("\n## mappings.") == 2
    assert "SetSmall and Twist: 3 numbers, 3 with all values, 768 values, 1 findings." in page
    assert "- **JML922 tried: JAUS Lossy drifts**\n- unchanged: `Sound`\n- `Lossy`: all 256" in page
    assert "- one way: `Only`\n" in page
    assert "SetOther and Bool: no numbers were tried.\n\n- left to Python: to_ros: lists" in page


@pytest.mark.parametrize(
    ("unchanged", "words"), [(256, "all 256 values; unchanged"), (200, "all 256 values; 56 change")]
)
def test_a_number_says_how_many_of_its_values_change(unchanged, words):
    made = FieldResult("JAUS", "Speed", "", 8, 1.0, (0.0, 255.0), 256, 256, has_way_back=True)
    made.unchanged, made.changed = unchanged, 256 - unchanged
    assert outcome_text(made) == words
