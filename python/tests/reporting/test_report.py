# SPDX-License-Identifier: Apache-2.0
"""The page as a whole: order, escaping, self-containedness, determinism, extension."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import plotly.graph_objects as go
import pytest
from reporting.page_parts import figures_of, headings_of, html_of
from reporting.synthetic_results import Results, make_results

from slipwise.errors import OutputError
from slipwise.logs.log import LeftOut, Log
from slipwise.reporting import SECTIONS, Contents, Figure, write_report

HOSTILE = '<script>alert("x")</script>&\'</script><img src=x onerror=alert(1)>'


@pytest.fixture(scope="module")
def results() -> Results:
    return make_results()


@pytest.fixture(scope="module")
def page(results: Results) -> str:
    return html_of(results)


def test_sections_stand_in_the_order_of_the_reader_s_questions(page: str) -> None:
    assert headings_of(page) == [
        "Does the learned model help?",
        "How far each method misses",
        "Where the robot drove, and what was predicted",
        "Errors over time",
        "Is the reported uncertainty true?",
        "Parameters while learning",
        "What arrives of commands",
        "The ground along the drive",
        "Learned slip, and the speeds and yaw rates driven",
        "Data left out, and what was guessed",
        "How to make this again",
    ]


def test_all_but_the_answer_is_folded_under_its_heading(page: str) -> None:
    assert page.count('<section id="section-1">') == 1
    folded = re.findall(r'<details class="section" id="(.*?)">', page)
    assert folded == [f"section-{place}" for place in range(2, len(SECTIONS) + 1)]
    assert "<details open" not in page


def test_same_results_give_the_same_bytes(page: str) -> None:
    assert html_of(make_results()) == page


def test_write_report_returns_the_path_it_wrote(tmp_path: Path, results: Results, page: str) -> None:
    path = tmp_path / "new folder" / "report.html"
    written = write_report(
        path, log=results.log, calibration=results.calibration, evaluation=results.evaluation, title="A drive"
    )
    assert written == path
    assert path.read_text(encoding="utf-8") == page


def test_folder_in_place_of_the_file_is_an_error_with_advice(tmp_path: Path, results: Results) -> None:
    with pytest.raises(OutputError, match="name a file"):
        write_report(
            tmp_path,
            log=results.log,
            calibration=results.calibration,
            evaluation=results.evaluation,
            title="x",
        )


def test_page_refers_to_nothing_outside_itself(page: str) -> None:
    without_plotly = re.sub(r"<script>.*?</script>", "", page, flags=re.DOTALL)
    assert not re.findall(r'(?:src|href)="(?!#|data:,")[^"]*"', without_plotly)
    assert "url(" not in without_plotly
    assert "default-src 'none'" in page


def test_page_of_a_short_drive_is_little_more_than_the_script_that_draws(page: str) -> None:
    assert page.count("plotly.js (cartesian - minified) v") == 1
    assert len(page.encode()) < 1_800_000


def test_every_figure_is_valid_plotly_with_units_on_its_axes(page: str) -> None:
    figures = figures_of(page)
    assert len(figures) == len(set(figures)) > 15
    for key, figure in figures.items():
        go.Figure(figure)  # raises on an unknown key or a wrong value
        axes = [figure["layout"][name] for name in ("xaxis", "yaxis") if name in figure["layout"]]
        assert len(axes) == 2, key
        assert all(re.search(r"\[.+\]", axis["title"]["text"]) for axis in axes), key


def test_hostile_names_are_shown_and_never_executed() -> None:
    results = make_results(runs=2, run_name=HOSTILE)
    log = results.log
    hostile = replace(
        results,
        log=Log(
            runs=log.runs,
            sources=(replace(log.sources[0], path=HOSTILE),),
            left_out=(LeftOut(HOSTILE, 1, HOSTILE, HOSTILE),),
            notes=(HOSTILE,),
        ),
    )
    page = html_of(hostile, title=HOSTILE, command=HOSTILE)
    assert "<script>alert" not in page
    assert "<img" not in re.sub(r"<script>.*?</script>", "", page, flags=re.DOTALL)
    assert page.count("&lt;script&gt;alert(&quot;x&quot;)&lt;/script&gt;") >= 8
    assert page.count("<script>") == 2  # Plotly and the page's own


def test_section_written_by_someone_else_is_shown_where_it_is_put(results: Results) -> None:
    class BatterySection:
        title = "Battery & charge"
        explanation = "How full the battery was."

        def html(self, contents: Contents) -> str:
            trace = {"type": "scatter", "x": [0, 1], "y": [1.0, float("nan")]}
            return Figure(key="battery", label=f"Battery of {contents.title}", traces=[trace]).html()

    page = html_of(results, sections=(SECTIONS[0], BatterySection(), *SECTIONS[1:]))
    assert headings_of(page)[1] == "Battery &amp; charge"
    assert figures_of(page)["figure-battery"]["data"][0]["y"] == [1, None]


def test_log_without_anything_in_it_gives_sentences_not_a_crash(results: Results) -> None:
    empty = replace(
        results,
        log=Log(runs=()),
        evaluation=replace(results.evaluation, scores=(), predictions=(), runs=(), methods=()),
        calibration=replace(results.calibration, history=None),
    )
    page = html_of(empty)
    assert page.count('class="missing"') >= 7
    assert len(headings_of(page)) == len(SECTIONS)
