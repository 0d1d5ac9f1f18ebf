"""Makes reader_support importable and offers a folder of documents."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture
def documents(tmp_path):
    from reader_support import Files

    return Files(tmp_path)
