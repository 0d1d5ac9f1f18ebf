"""Pictures in reports: known by their bytes, whatever they are labelled, and bounded."""

from __future__ import annotations

import base64

MOST_BYTES = 8 * 2**20
MOST_PIXELS = 40_000_000
"""What a browser unpacks without harm."""

_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8\xff"
_HEADERS = 2**18
"""Bytes of a JPEG within which its size stands."""

_FRAMES = {*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC}
"""Markers of JPEG that tell the size (ITU-T T.81, table B.1)."""


class NoPictureError(ValueError):
    """Bytes that the page does not show; the text says why."""


def picture_url(data: bytes) -> str:
    """Returns a URL that holds a picture, JPEG or PNG.

    Raises:
        NoPictureError: It is no such picture, or too large.
    """
    kind = "png" if data.startswith(_PNG) else "jpeg" if data.startswith(_JPEG) else ""
    if not kind:
        raise NoPictureError(f"it begins with {data[:4].hex(' ')}: neither JPEG nor PNG")
    if len(data) > MOST_BYTES:
        raise NoPictureError(f"it has {len(data)} bytes, more than {MOST_BYTES}")
    width, height = _size_of_png(data) if kind == "png" else _size_of_jpeg(data)
    if not 0 < width * height <= MOST_PIXELS:
        raise NoPictureError(f"it has {width} x {height} pixels, not 1 to {MOST_PIXELS}")
    return f"data:image/{kind};base64,{base64.b64encode(data).decode('ascii')}"


def _size_of_png(data: bytes) -> tuple[int, int]:
    if data[12:16] != b"IHDR" or len(data) < 24:
        raise NoPictureError("it is a PNG without a header")
    return int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")


def _size_of_jpeg(data: bytes) -> tuple[int, int]:
    at = 2
    while at + 9 <= min(len(data), _HEADERS) and data[at] == 0xFF:
        marker = data[at + 1]
        if marker in _FRAMES:
            return (
                int.from_bytes(data[at + 7 : at + 9], "big"),
                int.from_bytes(data[at + 5 : at + 7], "big"),
            )
        filling = marker == 0xFF
        at += 1 if filling else 2 + max(2, int.from_bytes(data[at + 2 : at + 4], "big"))
    raise NoPictureError("it is a JPEG without a header")
