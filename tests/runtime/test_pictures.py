"""Raw images as files of PGM and PPM: bytes, what is refused, and what comes back."""

from array import array

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime import conversions as c

SIZES = {"mono8": 1, "mono16": 2, "rgb8": 3, "bgr8": 3}


@pytest.mark.parametrize(
    ("image", "file"),
    [
        ((1, 2, "mono8", 0, 2, b"\x00\xff"), b"P5 2 1 255\n\x00\xff"),
        ((2, 1, "mono8", 1, 3, b"\x07ab\x08cd"), b"P5 1 2 255\n\x07\x08"),
        ((1, 2, "mono16", 0, 4, b"\xe8\x03\x01\x00"), b"P5 2 1 65535\n\x03\xe8\x00\x01"),
        ((1, 2, "mono16", 1, 4, b"\x03\xe8\x00\x01"), b"P5 2 1 65535\n\x03\xe8\x00\x01"),
        ((1, 2, "rgb8", 0, 6, b"\1\2\3\4\5\6"), b"P6 2 1 255\n\1\2\3\4\5\6"),
        ((2, 1, "bgr8", 0, 4, b"\1\2\3x\4\5\6x"), b"P6 1 2 255\n\3\2\1\6\5\4"),
    ],
)
def test_absolute_bytes_of_images(image, file):
    assert c.pixels_to_pnm(*image) == file
    assert c.pixels_to_pnm(*image[:5], array("B", image[5])) == file


@pytest.mark.parametrize(
    ("file", "image"),
    [
        (b"P5 2 1 255\n\x00\xff", (1, 2, "mono8", 0, 2, b"\x00\xff")),
        (b"P5\n1\t2\r\n65535 \x03\xe8\x00\x01", (2, 1, "mono16", 0, 2, b"\xe8\x03\x01\x00")),
        (b"P6# of 9 9\n# twice\n2 1\n255\n\1\2\3\4\5\6", (1, 2, "rgb8", 0, 6, b"\1\2\3\4\5\6")),
        (b"P5 1 1 255\n\n", (1, 1, "mono8", 0, 1, b"\n")),
        (b"P5 1 1 255\n#", (1, 1, "mono8", 0, 1, b"#")),
    ],
)
def test_absolute_bytes_of_files(file, image):
    assert c.pnm_to_pixels(file) == image


@pytest.mark.parametrize(
    "image",
    [
        (0, 0, "rgb8", 0, 0, b""),
        (1, 0, "mono8", 0, 1, b"a"),
        (1, 1, "rgba8", 0, 4, b"abcd"),
        (1, 1, "32FC1", 0, 4, b"abcd"),
        (1, 1, "", 0, 1, b"a"),
        (1, 2, "mono8", 0, 1, b"a"),  # the step is shorter than a row
        (2, 1, "mono8", 0, 1, b"a"),
        (1, 1, "mono8", 0, 1, b"ab"),
    ],
)
def test_images_that_have_no_file(image):
    with pytest.raises(c.ConversionError):
        c.pixels_to_pnm(*image)


@pytest.mark.parametrize(
    "file",
    [
        b"",
        b"\x89PNG\r\n\x1a\n",
        b"P2 1 1 255\n7",  # in digits
        b"P4 8 1\na",
        b"P5 1 1 255",
        b"P5 1 1 254\na",
        b"P5 1 1 65535\na",
        b"P6 1 1 65535\nabcdef",
        b"P6 1 1 255\nab",
        b"P6 1 1 255\nabcd",
        b"P5 0 0 255\n",
        b"P5 1000000000000 1 255\na",
        b"P5 -1 1 255\na",
        b"P5 #" + b" " * 100_000,
    ],
)
def test_files_that_have_no_image(file):
    with pytest.raises(c.ConversionError):
        c.pnm_to_pixels(file)


@given(
    st.sampled_from(sorted(SIZES)),
    st.integers(1, 5),
    st.integers(1, 5),
    st.integers(0, 3),
    st.booleans(),
    st.data(),
)
def test_each_pixel_comes_back(encoding, height, width, padding, is_big, data):
    size = SIZES[encoding]
    step = width * size + padding
    octets = data.draw(st.binary(min_size=height * step, max_size=height * step))
    back = c.pnm_to_pixels(c.pixels_to_pnm(height, width, encoding, is_big, step, octets))
    turned = encoding == "bgr8" or (encoding == "mono16" and is_big)
    assert back[:5] == (height, width, encoding.replace("bgr", "rgb"), 0, width * size)
    for row in range(height):
        for column in range(width):
            at, to = row * step + column * size, (row * width + column) * size
            pixel = octets[at : at + size]
            assert back.data[to : to + size] == (pixel[::-1] if turned else pixel)
    assert len(back.data) == height * width * size


@given(st.binary())
def test_any_octets_are_read_or_refused(octets):
    for file in (octets, b"P5 " + octets, b"P6 1 1 255\n" + octets):
        try:
            image = c.pnm_to_pixels(file)
        except c.ConversionError:
            continue
        assert c.pnm_to_pixels(c.pixels_to_pnm(*image)) == image
