"""Makes the pictures of docs/how-to/editor.md: `python tools/eclipse_pictures.py`.

tools/emf/EmfPicture.java draws them; it names the Debian packages that it needs, and Xvfb, the
package xvfb, is its display.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
JARS = Path("/usr/share/java")
NAMES = (*(f"eclipse-emf-{part}" for part in ("common", "ecore", "ecore-xmi", "edit")), "swt4")
METAMODELS = ("jaus", "ros", "bridge", "system")
PICTURES = {
    "eclipse-connection": "Connection velocity",
    "eclipse-assignment": "Field Assignment twist.angular.z",
}
"""The chosen element of each picture, by EMF's label."""


def main() -> int:
    """Command line entry."""
    path = ":".join(str(JARS / f"{name}.jar") for name in NAMES)
    metamodels = [ROOT / "metamodels" / f"{name}.ecore" for name in METAMODELS]
    model = ROOT / "models" / "minimal" / "minimal.xmi"
    with tempfile.TemporaryDirectory() as folder:
        program = ROOT / "tools" / "emf" / "EmfPicture.java"
        subprocess.run(["javac", "-cp", path, "-d", folder, program], check=True)
        java = ("java", "-cp", f"{folder}:{path}", "-Djava.library.path=/usr/lib/jni", "EmfPicture")
        for name, chosen in PICTURES.items():
            picture = ROOT / "docs" / f"{name}.png"
            command = ["xvfb-run", "--auto-servernum", *java, picture, chosen, *metamodels, model]
            subprocess.run(list(map(str, command)), check=True, stderr=subprocess.DEVNULL)
    return 0


if __name__ == "__main__":
    sys.exit(main())
