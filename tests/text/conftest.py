"""Makes the helpers of this folder and of tests/model importable; offers a folder of texts."""

import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "model")]


@pytest.fixture
def texts(tmp_path):
    from text_support import Texts

    return Texts(tmp_path)
