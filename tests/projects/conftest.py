"""Projects that `jausml init` makes, and the verb itself."""

import shutil

import pytest
from click.testing import CliRunner

from jausml.cli import main


@pytest.fixture(scope="session")
def jausml():
    """Runs a verb in this process, which ends with a status; returns what click says of it."""

    def run(*arguments, status=0):
        done = CliRunner().invoke(main, list(map(str, arguments)))
        assert done.exit_code == status, done.output
        return done

    return run


@pytest.fixture(scope="session")
def refused(jausml):
    """Runs a verb that is refused for a reason, and leaves what is beside a model as it was."""

    def run(reason, model, *arguments):
        before = {path: path.read_bytes() for path in model.parent.rglob("*") if path.is_file()}
        done = jausml(*arguments, status=2)
        assert reason in done.output
        after = {path: path.read_bytes() for path in model.parent.rglob("*") if path.is_file()}
        assert after == before

    return run


@pytest.fixture(scope="session")
def same_folder(tmp_path_factory):
    return tmp_path_factory.mktemp("projects")


@pytest.fixture
def tmp_path(same_folder):
    """The same folder for each test, empty: what earlier ones read of its library is shared.

    Copies of the library are kept by what messages call them, which is where they lie.
    """
    for path in same_folder.iterdir():
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()
    return same_folder


@pytest.fixture(scope="session")
def made_projects():
    """What projects were made of, and the folders where they lie; each is made once."""
    return {}


@pytest.fixture
def rover(tmp_path, tmp_path_factory, monkeypatch, jausml, made_projects):
    """Makes a project in a notation, empty unless told, and works in it; returns its model.

    Files may be added, by their paths, and verbs run in it; what others have made so is copied.
    """

    def make(notation, *verbs, origin="empty", files=()):
        root, made_of = tmp_path / "rover", (notation, verbs, origin, files)
        if made_of in made_projects:
            shutil.copytree(made_projects[made_of], root)
            monkeypatch.chdir(root)
        else:
            jausml("init", root, "--notation", notation, "--from", origin)
            monkeypatch.chdir(root)
            for path, text in files:
                (root / path).parent.mkdir(parents=True, exist_ok=True)
                (root / path).write_text(text, encoding="utf-8")
            for words in verbs:
                jausml(*words)
            kept = tmp_path_factory.mktemp("made") / "rover"
            made_projects[made_of] = shutil.copytree(root, kept)
        return root / "models" / f"rover.{'xmi' if notation == 'xmi' else 'ros2jaus'}"

    return make
