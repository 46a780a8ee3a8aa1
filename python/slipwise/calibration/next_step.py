# SPDX-License-Identifier: Apache-2.0
"""What to do after a verdict, in a few lines."""

from __future__ import annotations

from pathlib import Path
from shlex import quote

from slipwise.calibration.result import Verdict
from slipwise.models.schema import VerdictSection


def check_command(model: Path) -> str:
    """Return the command that judges a model on another log."""
    return f"slipwise evaluate OTHER_LOG --model {quote(str(model))}"


def export_command(model: Path) -> str:
    """Return the command that writes files for other tools from a model."""
    return f"slipwise export {quote(str(model))} --to all -o config"


def compare_command(model: Path) -> str:
    """Return the command that says what differs between a model and one that is learned again."""
    return f"slipwise compare {quote(str(model))} NEW.yaml"


def after_learning(verdict: Verdict | VerdictSection, model: Path) -> tuple[str, ...]:
    """Say what to do with a model that was just learned, or with the robot."""
    if not verdict.good:
        return _instead(verdict)
    steps = (f"  {check_command(model)}", f"  {export_command(model)}")
    return ("Next: check it on another day, then export it:", *steps)


def after_checking(verdict: Verdict | VerdictSection, model: Path) -> tuple[str, ...]:
    """Say what to do with a model file that was checked on a log it had not learned from."""
    if not verdict.good:
        return _instead(verdict)
    return ("Next: export it:", f"  {export_command(model)}")


def _instead(verdict: Verdict | VerdictSection) -> tuple[str, ...]:
    if verdict.advice:
        return ("Next: follow the advice below, then calibrate again.",)
    return ("Next: use commands or wheel speeds as they are; slipwise does not improve on them.",)
