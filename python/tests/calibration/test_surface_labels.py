# SPDX-License-Identifier: Apache-2.0
"""Labels of a log: from its column, from the command line; and its date."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_surfaces import FIRM, floor_log

from slipwise.calibration.prepared_run import prepare_run
from slipwise.calibration.surface_labels import (
    date_of,
    given_labels,
    label_at_start,
    labels_of,
    named_seconds,
    overruled,
)
from slipwise.errors import SettingsError
from slipwise.logs import Run


def run_with(*cells: object) -> Run:
    run = floor_log(FIRM, 1, seconds=10.0).runs[0]
    extra = {"t": np.linspace(0.0, 9.0, len(cells)), "terrain": np.array(cells, dtype=object)}
    return replace(run, extra=extra)


def test_a_label_counts_from_where_it_stands_first_and_empty_cells_say_nothing() -> None:
    cues = labels_of(run_with("sand", "", "sand", None, " ice ", float("nan"), "sand"))
    assert cues == ((0.0, "sand"), (6.0, "ice"), (9.0, "sand"))


def test_a_log_without_the_column_has_no_labels() -> None:
    assert labels_of(floor_log(FIRM, 1, seconds=10.0).runs[0]) == ()


def test_a_run_begins_with_a_label_that_stands_in_its_first_row() -> None:
    early, late = run_with("sand", "ice"), run_with("", "ice")
    assert label_at_start(labels_of(early), early) == "sand"
    assert label_at_start(labels_of(late), late) == ""


def test_one_label_stands_for_all_logs() -> None:
    assert given_labels((), 3) == ()
    assert given_labels(("sand",), 3) == ("sand",) * 3
    assert given_labels(("sand", "ice"), 2) == ("sand", "ice")


@pytest.mark.parametrize("labels", [("sand", "ice"), ("",), ("x" * 81,)])
def test_labels_that_do_not_go_with_the_logs_are_refused(labels: tuple[str, ...]) -> None:
    with pytest.raises(SettingsError, match="label"):
        given_labels(labels, 3)


def test_the_date_is_that_of_the_first_stamp_where_stamps_count_from_1970() -> None:
    log = floor_log(FIRM, 1, seconds=10.0)
    assert date_of(prepare_run(log, "wheel")) == ""
    run = log.runs[0]
    later = replace(run, poses=replace(run.poses, t=run.poses.t + 1.7e9))
    assert run.wheels is not None
    later = replace(later, commands=None, wheels=replace(run.wheels, t=run.wheels.t + 1.7e9))
    assert date_of(prepare_run(replace(log, runs=(later,)), "wheel")) == "2023-11-14"


def test_a_surface_that_labels_name_and_nothing_remembers_is_said() -> None:
    run = run_with("sand", "", "", "", "", "", "", "ice", "", "")  # 9 s
    log = replace(floor_log(FIRM, 1, seconds=10.0), runs=(run,))
    (drive,) = [prepare_run(log, "wheel")]
    named = named_seconds(drive)
    assert named["sand"] == pytest.approx(7.0, abs=0.2)
    assert named["ice"] == pytest.approx(3.0, abs=0.3)
    assert named_seconds(drive, "mud") == {"mud": pytest.approx(10.0, abs=0.3)}
    assert overruled(named, set()) == ()  # too short to be remembered
    assert overruled({"sand": 90.0, "ice": 60.0}, {"sand", "ice"}) == ()
    (found,) = overruled({"sand": 90.0, "ice": 60.0}, {"sand"})
    assert (found.spoils, found.reserves) == (False, True)
    assert "name ice for 60 s" in found.sentence
