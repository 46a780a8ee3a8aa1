# SPDX-License-Identifier: Apache-2.0
"""A user's parameter file gets what was learned and stays as it is else; what would be wrong is refused."""

from __future__ import annotations

import pytest
import yaml

from slipwise.errors import ModelError, SettingsError
from slipwise.export import ExportOptions, Merged, merge_firmware, merge_parameters, options_of
from slipwise.export.parameter_file import Entry, Kept, ParameterFile

MADE = ParameterFile(
    "base",
    [
        Entry(("gain",), 1.5, "learned"),
        Entry(("limits", "x.max"), 2.0, "learned too"),
        Entry(("noise",), [0.25, 0.0], "of both"),
        Entry(("kind",), "diff", "the kind", supposed=True),
        Kept(("lag",), "not identified"),
    ],
)
USERS = """\
# mine
other: {ros__parameters: {gain: 1.0}}
/robot/base:   # the base
    ros__parameters:
        gain: 1.0      # by hand
        limits:
            x: {max: 3.0, min: 0}
        noise:   # both
        - 0.5
        - 0.0
        # the last
"""


def merged(text: str, made: ParameterFile = MADE, options: ExportOptions | None = None) -> Merged:
    return merge_parameters(text, "users.yaml", made, options or ExportOptions())


def test_what_is_not_learned_stays_to_the_byte() -> None:
    wanted = USERS.replace("gain: 1.0      #", "gain: 1.5      #").replace("max: 3.0", "max: 2.0")
    wanted = wanted.replace("- 0.5", "- 0.25").replace(
        "- 0.0\n", '- 0.0\n        # the kind\n        kind: "diff"\n'
    )
    made = merged(USERS)
    assert made.text == wanted
    assert [(each.name, each.old, each.new) for each in made.changes] == [
        ("gain", "1.0", "1.5"),
        ("limits.x.max", "3.0", "2.0"),
        ("noise", "[0.5, 0.0]", "[0.25, 0.0]"),
        ("kind", "", '"diff"'),
    ]
    assert made.kept == {"lag": "not identified"}
    assert merged(made.text) == Merged(made.text, (), {"lag": "not identified"})
    crlf = merged(USERS.replace("\n", "\r\n")).text
    assert crlf == wanted.replace("\n", "\r\n")


def test_what_is_missing_is_added_in_order(subtests: pytest.Subtests) -> None:
    for text in (
        "base:\n  ros__parameters:\n    a: 1",
        "ns:\n  base:\n    ros__parameters: \n      a: [1,\n 2]\n",
    ):
        with subtests.test(text=text):
            parameters = yaml.safe_load(text) if text.startswith("base") else yaml.safe_load(text)["ns"]
            again = yaml.safe_load(merged(text).text)
            again = again if text.startswith("base") else again["ns"]
            added = {"gain": 1.5, "limits.x.max": 2.0, "noise": [0.25, 0.0], "kind": "diff"}
            assert again["base"]["ros__parameters"] == parameters["base"]["ros__parameters"] | added
            assert list(again["base"]["ros__parameters"]) == ["a", *added]


def test_what_would_be_wrong_is_refused_whole(subtests: pytest.Subtests) -> None:
    start = "base:\n  ros__parameters:\n    "
    cases = {
        f"{start}kind: omni": (ModelError, 'the numbers are for kind = "diff", and users.yaml has omni'),
        f"{start}gain: $(var gain)": (ModelError, "gain cannot be written: a launch file puts its value in"),
        f"{start}a: &g 1.0\n    gain: *g": (ModelError, "other values are written by its anchor"),
        f"{start}noise: [1.0]": (ModelError, "it has 1 numbers in the file, and 2 are to be written"),
        f"{start}gain: {{a: 1}}": (ModelError, "the file has something else by its name"),
        "base: {ros__parameters: {a: 1}}": (ModelError, "its place in the file is not a block of lines"),
        f"a/{start}gain: 1.0\nb/{start}gain: 1.0": (SettingsError, "several nodes in it could be base"),
        f"another{start}x: 1.0": (SettingsError, r"no node in it could be base \(anotherbase\)"),
        "base: [": (SettingsError, "it is no YAML"),
        "base: 1": (SettingsError, "no node in it has ros__parameters"),
    }
    for text, (error, said) in cases.items():
        with subtests.test(text=text), pytest.raises(error, match=said):
            merged(text)


def test_a_factor_of_wheels_is_for_the_one_in_force() -> None:
    made = ParameterFile("base", [Entry(("wheel_separation_multiplier",), 1.2, "learned")])
    text = "base:\n  ros__parameters:\n    wheel_separation_multiplier: 1.1\n"
    with pytest.raises(ModelError, match=r"the file has 1.1, .* --logged-separation-multiplier"):
        merged(text, made)
    assert "1.2" in merged(text, made, ExportOptions(logged_separation_multiplier=1.1)).text


def test_the_file_says_how_its_tools_run() -> None:
    text = (
        "controller_manager:\n  ros__parameters:\n    update_rate: 100\n"
        "controller_server:\n  ros__parameters:\n    Follow:\n"
        "      plugin: nav2_mppi_controller::MPPIController\n"
        "      time_steps: 30\n      model_dt: 0.1\n"
        "ekf_filter_node:\n  ros__parameters:\n    frequency: 50.0\n"
    )
    options = options_of(text, "users.yaml", ExportOptions())
    assert (options.update_rate, options.filter_rate) == (100.0, 50.0)
    assert options.planning_horizon == pytest.approx(3.0)


def test_lines_of_an_autopilot(subtests: pytest.Subtests) -> None:
    made = "# top\n\n# [m/s] sure\n{}1.25{}\n# other\n{}2{}\n"
    for first, second in (("SPEED,", "ACCEL,"), ("1\t1\tSPEED\t", "1\t1\tACCEL\t")):
        with subtests.test(first=first):
            end = "\t9" if "\t" in first else ""
            users = f"# mine\n{first}1.0{end}\nOTHER,3\n"
            found = merge_firmware(users, "a.param", made.format(first, end, second, end), {"LAG": "unknown"})
            assert found.text == users.replace("1.0", "1.25")
            (change,) = found.changes
            assert (change.name, change.old, change.why) == ("SPEED", "1.0", "[m/s] sure")
            assert found.kept == {"LAG": "unknown", "ACCEL": "the file does not have it"}
    with pytest.raises(SettingsError, match="no line of it is a parameter"):
        merge_firmware("nothing\n", "a.param", made, {})
