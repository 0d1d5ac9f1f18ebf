"""The diagram as a file of the user: SVG of the server, PNG that the browser makes of it."""

from pathlib import Path

import pytest
from desktop import Desktop

pytestmark = [pytest.mark.slow, pytest.mark.needs("chromium", "page"), pytest.mark.ports]

CAR = Path(__file__).resolve().parents[3] / "models" / "catvehicle" / "catvehicle.xmi"


def test_the_diagram_is_saved(open_studio):
    desk = Desktop(open_studio(CAR))
    for kind, begins in (("svg", b"<svg"), ("png", b"\x89PNG")):
        with desk.page.expect_download() as saved:
            desk.page.get_by_label("Export the diagram").select_option(kind)
        assert saved.value.suggested_filename == f"system.{kind}"
        data = Path(saved.value.path()).read_bytes()
        assert data.startswith(begins)
        assert len(data) > 10_000
