"""Makes text_support importable and offers a folder of texts."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture
def texts(tmp_path):
    from text_support import Texts

    return Texts(tmp_path)
