# SPDX-License-Identifier: Apache-2.0
"""PGM images: what is written is read, both spellings, and what is wrong is named."""

from pathlib import Path

import numpy as np
import pytest

from slipwise.errors import PlanningError
from slipwise.planning.pgm import read_levels, read_pgm, write_pgm


def saved(folder: Path, data: bytes) -> Path:
    path = folder / "map.pgm"
    path.write_bytes(data)
    return path


def test_what_is_written_is_read_top_row_first(tmp_path: Path) -> None:
    grey = np.array([[0.0, 1.0, 0.2], [0.6, 0.8, 0.4]])
    np.testing.assert_allclose(read_pgm(write_pgm(tmp_path / "map.pgm", grey)), grey, atol=1e-12)


def test_grey_beyond_black_and_white_is_cut(tmp_path: Path) -> None:
    read = read_pgm(write_pgm(tmp_path / "map.pgm", np.array([[-0.5, 1.5]])))
    assert read.tolist() == [[0.0, 1.0]]


def test_plain_and_binary_of_one_or_two_bytes_with_comments_are_read(tmp_path: Path) -> None:
    plain = saved(tmp_path, b"P2 # by hand\n# and more\n2 1\n100\n 25\n100\n")
    assert read_pgm(plain).tolist() == [[0.25, 1.0]]
    binary = saved(tmp_path, b"P5\n2 1 200\n" + bytes([50, 200]))
    assert read_pgm(binary).tolist() == [[0.25, 1.0]]
    wide = saved(tmp_path, b"P5\n2 1\n1000\n" + (250).to_bytes(2, "big") + (1000).to_bytes(2, "big"))
    levels, white = read_levels(wide)
    assert (levels.tolist(), white) == ([[250, 1000]], 1000)


def test_an_image_that_is_wrong_is_refused_by_name(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for data, said in [
        (b"", "is no PGM image"),
        (b"P6\n2 1\n255\n123456", "is no PGM image"),
        (b"P5\n0 1\n255\n", "claims 0 x 1 pixels"),
        (b"P5\n2 1\n0\n12", "claims 2 x 1 pixels up to 0"),
        (b"P5\n2 2\n255\n123", "is cut off: 3 of 4 pixels"),
        (b"P5\n2 1\n10\n\x05\x0b", "has a pixel of 11, where white is 10"),
        (b"P2\n2 1\n255\n1 x", "holds something that is not a number"),
        *((b"P2\n2 1\n255\n1 " + level, "holds something that is not") for level in (b"-1", b"nan", b"1e99")),
        (b"P5\n99999 99999\n255\n", "more than"),
    ]:
        with subtests.test(data=data, said=said):
            path = saved(tmp_path, data)
            with pytest.raises(PlanningError) as caught:
                read_pgm(path)
            assert said in str(caught.value)
            assert "map.pgm" in str(caught.value)
            assert "\n" not in str(caught.value)


def test_a_map_may_have_as_many_pixels_as_allowed(tmp_path: Path) -> None:
    path = write_pgm(tmp_path / "map.pgm", np.zeros((4, 5)))
    assert read_pgm(path, most_pixels=20).shape == (4, 5)
    with pytest.raises(PlanningError, match="more than 19"):
        read_pgm(path, most_pixels=19)
