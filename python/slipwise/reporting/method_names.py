# SPDX-License-Identifier: Apache-2.0
"""What the methods are called on the page, the same everywhere, and what each of them does."""

from __future__ import annotations

from slipwise.reporting.contents import LEARNED, PLAIN, SIMPLE, VENDOR, Contents

BASELINE = "kinematic baseline"
_LABELS = {PLAIN: BASELINE, VENDOR: "vendor multiplier", LEARNED: "slipwise", "model": "model file"}
_WORDS = {
    VENDOR: "the baseline, turning by the maker's wheel-separation multiplier",
    LEARNED: "several slip bases, averaged by how well each predicts",
    "model": "the model file as it is",
    "batch": "one fit of the whole log",
}


def label(method: str, contents: Contents) -> str:
    """Return the name of a method; that of slipwise holds the basis or estimator, where it is not `auto`."""
    if method == contents.learned_method and method not in _LABELS:
        return f"slipwise ({method})"
    return _LABELS.get(method, method)


def explanation(method: str, contents: Contents) -> str:
    """Return in a few words what a method does, empty where its name is all there is to say."""
    from_commands = contents.evaluation.input == "command"
    source = "commands" if from_commands else "wheel speeds"
    if method == PLAIN:
        return f"the robot follows the {source} at once: no slip" + (
            ", lag or delay" if from_commands else ""
        )
    if method == SIMPLE:
        return "two fitted factors, of speed and of yaw rate" + (
            ", with lag and delay" if from_commands else ""
        )
    return _WORDS.get(method, "")
