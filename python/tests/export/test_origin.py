# SPDX-License-Identifier: Apache-2.0
"""Where an exported file comes from, in lines that stay within their comment whatever the model says."""

from dataclasses import replace

import pytest
from sample_models import make_model, named

from slipwise.export.origin import one_line, origin_lines

HOSTILE = "a */ b\n#define X ??/\x00\r\u2028/* c"


def test_nothing_ends_a_comment_or_a_line(subtests: pytest.Subtests) -> None:
    for text in [HOSTILE, "**//", "/**/*/", "???/", "?" * 9]:
        with subtests.test(text=text):
            said = one_line(text)
            assert not any(mark in said for mark in ("*/", "/*", "??"))
            assert len(said.splitlines()) == 1
            assert said.isprintable()


def test_plain_words_stay_and_long_ones_are_cut() -> None:
    assert one_line("  a  good\tmodel ") == "a good model"
    assert len(one_line("x" * 5000)) == 400


def test_the_lines_name_log_verdict_and_range() -> None:
    made = replace(named("edd-2"), speed=(-0.5, 1.5), yaw_rate=(-1.0, 1.0), good=False, identifiable=False)
    text = "\n".join(origin_lines(make_model(made), "robot.yaml"))
    assert "model robot.yaml" in text
    assert "log: drives/monday.mcap" in text
    assert "NOT GOOD ENOUGH" in text
    assert "speeds -0.5 to 1.5 m/s and yaw rates -1 to 1 rad/s" in text
    assert "not identifiable from the log" in text


def test_a_hostile_log_name_and_sentence_stay_one_line_each() -> None:
    made = replace(named("edd-2"), log=HOSTILE, sentence=HOSTILE)
    for line in origin_lines(make_model(made), HOSTILE):
        assert line == one_line(line)
