# SPDX-License-Identifier: Apache-2.0
"""The section of the provenance."""

from __future__ import annotations

from dataclasses import replace
from html import unescape

from reporting.page_parts import contents_of, text_of
from reporting.synthetic_results import make_results

from slipwise.logs.log import Log
from slipwise.reporting.sections.provenance import ProvenanceSection


def test_version_command_hash_settings_and_model_are_there() -> None:
    results = make_results()
    html = ProvenanceSection().html(contents_of(results, command="slipwise demo --seed 3"))
    text = text_of(html)
    assert "slipwise version 0.0.test" in text
    assert "command line slipwise demo --seed 3" in text
    assert f"/data/field.mcap mcap 2400 {'ab' * 32}" in text
    assert '"basis": "auto"' in unescape(html)
    assert results.calibration.model.to_yaml() in unescape(html)


def test_log_that_was_only_learned_from_is_listed_too() -> None:
    results = make_results()
    text = text_of(ProvenanceSection().html(contents_of(replace(results, log=Log(runs=results.log.runs)))))
    assert f"/data/field.mcap learned from {'ab' * 32}" in text
