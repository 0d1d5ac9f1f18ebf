"""What is kept in the cache of the user is believed under the seal of that user alone."""

from __future__ import annotations

import os
import time

import pytest

from jausml.language.model.cache import keep, kept

CONTENT = {"names": ["one", "other"], "count": 3}


@pytest.fixture(autouse=True)
def folders(tmp_path, monkeypatch):
    """The folders of the cache and of the key, of this test alone."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return tmp_path


@pytest.fixture
def file(folders):
    """A file of the cache."""
    keep("it", "now", CONTENT)
    return folders / "cache" / "jausml" / "it"


def test_what_is_kept_is_found_for_its_name_and_state_alone(file):
    assert kept("it", "now") == CONTENT
    assert kept("it", "then") is None
    assert kept("other", "now") is None
    file.rename(file.with_name("other"))
    assert kept("other", "now") is None


def test_a_new_state_takes_the_place_of_the_old_one(file):
    keep("it", "later", [1])
    assert (kept("it", "now"), kept("it", "later")) == (None, [1])
    assert [each.name for each in file.parent.iterdir()] == ["it"]


def test_no_byte_can_be_changed(file):
    data = file.read_bytes()
    for position in range(len(data)):
        file.write_bytes(data[:position] + bytes([data[position] ^ 1]) + data[position + 1 :])
        assert kept("it", "now") is None, position
    for wrong in (b"", data[:31], data[:-1], data + b"\0"):
        file.write_bytes(wrong)
        assert kept("it", "now") is None
    file.write_bytes(data)
    assert kept("it", "now") == CONTENT


@pytest.mark.usefixtures("file")
def test_what_was_kept_with_another_key_is_as_if_it_were_not_there(folders):
    (folders / "state" / "jausml" / "seal").unlink()
    assert kept("it", "now") is None
    keep("it", "now", CONTENT)
    assert kept("it", "now") == CONTENT


@pytest.mark.skipif(os.name != "posix", reason="permissions are those of POSIX")
def test_a_key_that_others_can_read_seals_nothing(file, folders):
    key = folders / "state" / "jausml" / "seal"
    assert key.stat().st_mode & 0o777 == file.stat().st_mode & 0o777 == 0o600
    key.chmod(0o640)
    assert kept("it", "now") is None
    keep("it", "then", CONTENT)
    key.chmod(0o600)
    assert kept("it", "then") is None
    key.write_bytes(b"")
    assert kept("it", "now") is None


def test_where_nothing_can_be_kept_nothing_is_lost(file, folders):
    for each in (file, folders / "state" / "jausml" / "seal"):
        each.unlink()
        each.mkdir()
    keep("it", "now", CONTENT)
    assert kept("it", "now") is None


def test_what_was_not_written_for_a_month_is_removed(file):
    old = time.time() - 31 * 24 * 3600
    os.utime(file, (old, old))
    keep("other", "now", CONTENT)
    assert [each.name for each in file.parent.iterdir()] == ["other"]
