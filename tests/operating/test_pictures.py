"""Pictures of a component in a page: by their content, whatever they are labelled."""

import base64
import struct
import zlib
from typing import Any

import pytest
from simulated_vehicle import until
from studio_client import Page, RefusedError

from jausml import Component
from jausml.live.operating.values import MOST_BYTES, picture_url
from jausml.live.peers.query_client import Refused

CAMERA = "100.1.20"


def png(width: int, height: int) -> bytes:
    """A grey picture, made by the standard of the format (ISO/IEC 15948)."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        check = zlib.crc32(kind + data).to_bytes(4, "big")
        return len(data).to_bytes(4, "big") + kind + data + check

    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    rows = zlib.compress(b"".join(b"\0" + b"\x80" * width for _ in range(min(height, 64))))
    parts = (chunk(b"IHDR", header), chunk(b"IDAT", rows), chunk(b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


def jpeg(width: int, height: int) -> bytes:
    """The beginning of a JPEG: the segments of JFIF and of its frame."""
    frame = struct.pack(">BHHB", 8, height, width, 1) + bytes(3)
    return (
        b"\xff\xd8\xff\xe0\x00\x10JFIF" + bytes(10)
        + b"\xff\xc0" + struct.pack(">H", len(frame) + 2) + frame + b"\xff\xd9"
    )  # fmt: skip


@pytest.mark.parametrize(
    ("data", "kind"), [(png(4, 3), "png"), (jpeg(640, 480), "jpeg")], ids=["png", "jpeg"]
)
def test_a_picture_is_a_url_of_its_own_kind(data, kind):
    head, _, rest = picture_url(data).partition(",")
    assert head == f"data:image/{kind};base64"
    assert base64.b64decode(rest) == data


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"", "neither JPEG nor PNG"),
        (b"GIF89a" + bytes(40), "47 49 46 38"),
        (b"<svg onload='alert(1)'/>", "neither JPEG nor PNG"),
        (png(100_000, 100_000), "pixels"),
        (png(0, 4), "pixels"),
        (jpeg(65535, 65535), "pixels"),
        (jpeg(4, 4)[:12], "without a header"),
        (png(4, 4)[:20], "without a header"),
        (b"\xff\xd8" + b"\xff" * 5000, "without a header"),
        (b"\xff\xd8\xff\xe0\x00\x00" + bytes(5000), "without a header"),
        (png(4, 4) + bytes(MOST_BYTES), "bytes"),
    ],
)  # fmt: skip
def test_what_a_browser_should_not_unpack_is_no_picture(data, why):
    with pytest.raises(Refused, match=why):
        picture_url(data)


@pytest.mark.ports
def test_the_picture_of_a_component_is_shown_by_its_content(commanding, port):
    shown = [png(8, 8)]
    asked: list[Any] = []

    def picture() -> dict[str, Any]:
        asked.append(1)
        record = {
            "SensorID": 1,
            "ReportCoordinateSystem": 0,
            "ImageFrame": {"format": 0, "hex": shown[0].hex()},  # says JPEG, whatever it is
        }
        return {"StillImageDataList": [record]}

    with Component(CAMERA, provides="StillImage", name="camera", port=port) as component:
        component.answer("StillImageData", picture)
        of = {"component": CAMERA, "report": "ReportStillImageData"}
        until(lambda: is_watched(commanding))

        def last() -> Any:
            return commanding.ask("values")["values"][0]

        until(lambda: last()["pictures"])
        [path] = last()["pictures"]
        assert commanding.ask("picture", path=path, **of)["url"] == picture_url(png(8, 8))
        # The bytes themselves are told in short.
        assert all(len(text) < 250 for _, text in last()["fields"])
        shown[0] = b"GIF89a" + bytes(500)
        count = last()["count"]
        until(lambda: last()["count"] > count + 1)
        with pytest.raises(RefusedError, match="neither JPEG nor PNG"):
            commanding.ask("picture", path=path, **of)
        with pytest.raises(RefusedError, match="neither JPEG nor PNG"):
            commanding.ask("picture", path="elsewhere", **of)
        commanding.ask("unwatch", **of)


def is_watched(page: Page) -> bool:
    record = {"SensorID": 1, "ReportCoordinateSystem": 0, "QueryPresenceVector": 1}
    fields = {"QueryStillImageDataList": [record]}
    try:
        page.ask("watch", component=CAMERA, report="StillImageData", rate=5, fields=fields)
    except RefusedError:
        return False
    return True
