"""The modules of the project, for tests that look at all of them."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = {
    "jausml": ROOT / "jausml",
    "jausml_generators": ROOT / "generators" / "jausml_generators",
}


def modules_below(*folders: Path) -> list[Path]:
    """All modules in folders, by default in all packages; one without any is a test of nothing."""
    found = {folder: sorted(folder.rglob("*.py")) for folder in folders or PACKAGES.values()}
    assert all(found.values()), [str(folder) for folder, paths in found.items() if not paths]
    return [path for paths in found.values() for path in paths]
