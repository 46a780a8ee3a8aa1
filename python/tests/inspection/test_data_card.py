# SPDX-License-Identifier: Apache-2.0
"""A data card says what the log cannot, what was measured, and what was identified; it is read back equal."""

from __future__ import annotations

from pathlib import Path

import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.errors import LogError
from slipwise.inspection import Stated, inspect_log
from slipwise.inspection.data_card import NOT_STATED, DataCard, make_card, read_card, write_card
from slipwise.logs import open_log, save_log


@pytest.fixture(scope="module")
def card(tmp_path_factory: pytest.TempPathFactory) -> DataCard:
    path = tmp_path_factory.mktemp("card") / "drive.parquet"
    drive = Drive(seconds=60.0, basis=_core.named_basis("edd-2"), alpha=(-0.1, -0.3))
    save_log(simulated_log(drive), path)
    return make_card(path, inspect_log(open_log(path)), Stated(licence="CC0-1.0"), anonymised=False)


def test_what_was_not_said_is_not_stated(card: DataCard) -> None:
    assert (card.licence, card.vehicle, card.sensors) == ("CC0-1.0", NOT_STATED, NOT_STATED)
    assert card.anonymised == ""


def test_streams_have_their_rates(card: DataCard) -> None:
    assert {stream.name: round(stream.rate or 0.0, 6) for stream in card.streams} == {
        "commands": 20.0,
        "wheels": 20.0,
        "poses": 20.0,
    }
    assert card.distance > 10.0


def test_what_was_identified_is_near_the_truth(card: DataCard) -> None:
    (turning,) = (number for number in card.identified["wheel"] if number.name == "ang.w")
    assert abs(turning.value - -0.3) < 3.0 * turning.std + 0.02


def test_a_card_is_read_back_equal(card: DataCard, tmp_path: Path) -> None:
    write_card(card, tmp_path / "a.card.yaml")
    assert read_card(tmp_path / "a.card.yaml") == card


def test_what_is_no_card_is_a_clear_error(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for damage in ["card: 2\n", "licence: [1]\n", "{", "a: &x 1\nb: *x\n", "\0", ""]:
        with subtests.test(damage=damage):
            path = tmp_path / "a.card.yaml"
            path.write_text(damage)
            with pytest.raises(LogError, match=r"a\.card\.yaml"):
                read_card(path)
