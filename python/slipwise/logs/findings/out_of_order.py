# SPDX-License-Identifier: Apache-2.0
"""Finds samples that came out of order: those that go back in time are left out, which is said."""

from __future__ import annotations

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.seen import WORDS, WholeLog
from slipwise.logs.left_out import samples_left_out
from slipwise.logs.stamps import BACKWARD

_MANY = (20, 0.05)  # so many, and of all samples


class OutOfOrder(Check):
    """Poses or inputs of which many go back in time."""

    kind, family, spoils, reserves = "out-of-order", "clocks", False, True
    of_input = True
    means = "rows are not in the order of time, or a network overtakes itself"
    shows = "20 and 5 % of the poses, or of the inputs that are learned from, are earlier than one before"
    cure = "sort the table by `t`; date messages when they are measured"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Compare what the reader left out with what it kept."""
        inputs = WORDS[whole.input_name].name
        series = [run.commands if whole.input_name == "command" else run.wheels for run in whole.log.runs]
        kept = {
            "poses": sum(len(run.poses.as_measured) for run in whole.log.runs),
            inputs: sum(len(each) for each in series if each is not None),
        }
        counts = {name: samples_left_out(whole.log, name, BACKWARD) for name in kept}
        worst = max(kept, key=lambda name: counts[name] / max(kept[name], 1))
        back, count = counts[worst], counts[worst] + kept[worst]
        if back < _MANY[0] or back < _MANY[1] * count:
            return None
        return self.found(
            f"{back} of {count} {worst} are earlier than one that came before them, and are "
            "left out: they are not in the order of time",
            "Sort the table by t, or date messages when they are measured.",
            evidence=back / count,
        )
