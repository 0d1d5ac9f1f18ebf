"""How many messages generated codecs encode and decode each second, beside bare struct packing."""

from __future__ import annotations

import importlib.util
import inspect
import struct
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from figures import rounded

from jausml.generation import render
from jausml.language.model import read_models
from jausml.runtime import messages as core_messages
from jausml_generators.messages.target import TARGET as MESSAGES

if TYPE_CHECKING:
    from scale import Scale

ROOT = Path(__file__).resolve().parent.parent
SECONDS = 0.4
"""Time for each measurement."""


def vehicle_messages(folder: Path) -> ModuleType:
    """Generates the velocity messages of the example and imports them on the checkout's runtime."""
    model = read_models([ROOT / "models" / "catvehicle" / "catvehicle.xmi"]).model
    texts = {artifact.path: artifact.text for artifact in render(model, [MESSAGES])}
    path = folder / "vehicle_messages.py"
    name = "catvehicle_messages/catvehicle_messages/velocity_state_sensor.py"
    text = texts[name].replace("jausml_runtime", "jausml.runtime")
    path.write_text(text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("vehicle_messages", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["vehicle_messages"] = module
    spec.loader.exec_module(module)
    return module


def rate(action: Callable[[], object], seconds: float) -> float:
    """Returns calls each second: the best of three runs, since others use the machine too."""
    best = 0.0
    for _ in range(3):
        count, started = 0, time.perf_counter()
        while (elapsed := time.perf_counter() - started) < seconds:
            for _ in range(200):
                action()
            count += 200
        best = max(best, count / elapsed)
    return best


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures a small, a typical and a list message, and bare struct packing for scale.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        `bare`, and for each message `encode` and `decode`, all in calls each second; `bytes` on the
        wire and `lines` of generated code, docstrings included.
    """
    vehicle = vehicle_messages(folder)
    typical = vehicle.ReportVelocityState(
        velocity_x=5.0,
        velocity_y=0.0,
        yaw_rate=0.1,
        time_stamp=vehicle.ReportVelocityState.TimeStamp(1, 2, 3, 4, 5),
    )
    services = core_messages.ReportServices
    service = services.ServiceRec("urn:jaus:jss:mobility:PrimitiveDriver", 1, 0)
    component = services.ComponentSeq(services.ComponentRec(1, 0), [service] * 8)
    listed = services([services.NodeSeq(services.NodeRec(1), [component])])
    samples = {
        "small: ReportStatus": core_messages.ReportStatus(1, 0),
        "typical: ReportVelocityState with 4 fields": typical,
        "list: ReportServices with 8 services": listed,
    }
    seconds = max(SECONDS * scale.factor, 0.005)
    bare = struct.Struct("<HHIIHI")
    found: dict[str, Any] = {}
    for name, message in samples.items():
        payload, decode = message.encode(), type(message).decode
        found[name] = {
            "encode": rounded(rate(message.encode, seconds)),
            "decode": rounded(rate(partial(decode, payload), seconds)),
            "bytes": len(payload),
            "lines": len(inspect.getsourcelines(type(message))[0]),
        }
        print(f"  {name}: {found[name]}", flush=True)
    packed = rate(lambda: bare.pack(0x4404, 0x143, 1, 2, 3, 4), seconds)
    return {"bare": rounded(packed), "messages": found}
