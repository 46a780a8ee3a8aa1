# SPDX-License-Identifier: Apache-2.0
"""The uses of what was learned: each holds what slipwise gives against the truth of the situation.

To add one is to write a function and to add it to `USES`.
"""

from __future__ import annotations

import html
import re
from collections.abc import Callable

from matrix import drives, exports, streams, trailer
from matrix.learned import Learned, verb

from slipwise.models.parameter_table import physical_parameters

SIGMAS = 4.0  # within which a learned number holds the truth
Use = Callable[[Learned], None]


def inspect(learned: Learned) -> None:
    """Every sample is counted, used or left out, and the chosen input can be learned from."""
    said = verb("inspect", learned.log, "--json", "-", *learned.reading, *learned.settings).document
    assert not said["problem"], said["problem"]
    parts = [part for survey in said["files"] for part in survey["parts"]]
    silent = [part["name"] for part in parts if not (part["used_as"] or part["why"])]
    assert parts, "no column is named"
    assert not silent, f"{silent} are not used, and nothing says why"
    known = [each for each in said["learnable"] if each["input"] == learned.situation.learns]
    assert known, f"nothing can be learned from {learned.situation.learns}s"
    assert any(p["identifiable"] for p in known[0]["parameters"]), known[0]["missing"]


def calibrate(learned: Learned) -> None:
    """The verdict is good, and each learned number lies within its own covariance of the truth."""
    said = learned.calibration.document
    assert learned.calibration.code == 0, said["verdict"]["sentence"]
    unsaid = [note for note in learned.situation.notes if not re.search(note, " ".join(said["notes"]))]
    assert not unsaid, f"{unsaid} is not said: {said['notes']}"
    found = {p.name: p for p in physical_parameters(learned.model)}
    wrong = [
        f"{name} is {found[name].value:.4g} +- {found[name].std:.2g}, in truth {truth:g}"
        for name, truth in learned.situation.truth.items()
        if abs(found[name].value - truth) > SIGMAS * found[name].std
    ]
    assert not wrong, "; ".join(wrong)
    known = {p.name.removeprefix("log_"): p.std < 0.5 * p.prior_std for p in learned.model.content.parameters}
    assert not (open_ := [name for name in learned.situation.truth if not known[name]]), f"{open_} stay open"


def show(learned: Learned) -> None:
    """The sentences say what the truth is, and nothing that is false."""
    said = " ".join(verb("show", learned.path, "--json", "-").document["summary"])
    assert said
    missing = [pattern for pattern in learned.situation.says if not re.search(pattern, said)]
    false = [pattern for pattern in learned.situation.never if re.search(pattern, said)]
    assert not missing, f"does not say {missing}: {said}"
    assert not false, f"says {false}: {said}"


def report(learned: Learned) -> None:
    """The report is one page that has the verdict and every learned number."""
    page = learned.folder / "report.html"
    learned.calibrated(learned.log, "reported", "--report", page)
    text = html.unescape(page.read_text(encoding="utf-8"))
    assert learned.model.verdict.sentence[:60] in text
    missing = [p.name for p in physical_parameters(learned.model) if p.name not in text]
    assert not missing, f"{missing} do not stand in the report"


def compare(learned: Learned) -> None:
    """Two drives of one robot do not differ; another robot does, and its model is the better one of it."""
    situation = learned.situation
    again = learned.taught("again", 2)
    said = verb("compare", learned.path, again, "--json", "-").document
    assert said["differences"], "no number is compared"
    false = [row["name"] for row in said["differences"] if row["different"]]
    assert len(false) <= 1, f"of one robot {false} differ"
    assert situation.changed is not None
    changed = learned.taught("changed", 3, situation.changed)
    told = verb("compare", learned.path, changed, "--json", "-").document
    assert any(row["different"] for row in told["differences"]), "of another robot nothing differs"
    log = situation.write(learned.folder, "changed-other", 4, situation.changed)
    told = verb("compare", learned.path, changed, log, "--json", "-", *learned.reading).document
    sentence = told["predictions"]["sentences"][0]
    assert re.match("changed.yaml predicts (this robot|positions) better", sentence), sentence


def evaluate(learned: Learned) -> None:
    """On another log the model beats the kinematic baseline, and what it says of its errors is true."""
    said = verb(
        *("evaluate", learned.other, "--model", learned.path, "--methods", "none,model", "--json", "-"),
        *("--runs", learned.folder / "runs", *learned.reading, *learned.settings),
    )
    scores = [each for each in said.document["scores"] if each["method"] == "model" and each["windows"]]
    assert said.code == 0, scores
    worst = max(each["heading_ratio"][0] for each in scores)
    assert worst < 0.7, f"heading errors are {worst:.2f} of the baseline's"


def fleet(learned: Learned) -> None:
    """Of four robots the one that is another stands out, and of the three others none does."""
    situation = learned.situation
    assert situation.changed is not None
    robots = {f"robot-{k}": situation.robot for k in range(3)} | {"odd": situation.changed}
    said, results = learned.fleet("robots", robots, days=2)
    alarms = {finding["vehicle"] for finding in said.document["findings"] if finding["alarm"]}
    tests = len(said.document["findings"])
    odd = [each for each in said.document["findings"] if each["kind"] == "odd"]
    assert all(abs(each["size"]) > 0.8 * each["least"] for each in odd if each["alarm"])
    page = (results / "fleet.html").read_text(encoding="utf-8")
    assert re.search("unlike the others stands out from .* in (lon|ang|speed|curvature)", page)
    assert alarms == {"odd"}, f"{', '.join(sorted(alarms)) or 'none'} stand out in {tests} tests"


USES: dict[str, Use] = {
    "inspect": inspect,
    "calibrate": calibrate,
    "show": show,
    "report": report,
    "compare": compare,
    "evaluate": evaluate,
    "predict": drives.predict,
    "rollout": drives.rollout,
    "mppi": drives.mppi,
    "trajectory": drives.trajectory,
    "c-header": drives.header,
    "excite": drives.excite,
    "replay": streams.replay,
    "lines": streams.lines,
    "pushed": streams.pushed,
    "ahead": streams.ahead,
    "parquet": streams.parquet,
    "mcap": streams.mcap,
    "fleet": fleet,
    **{f"to-{name}": use for name, use in exports.TARGETS.items()},
}
#: Uses of single situations.
OWN: dict[str, Use] = {"dynamics": trailer.dynamics, "several-logs": streams.several_logs}
