# SPDX-License-Identifier: Apache-2.0
"""The mechanisms of the learner: how each is switched off, and which lines of source it costs."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from variants import Variant

ROOT = Path(__file__).resolve().parents[1]
NEVER, ALMOST_NONE = 1e9, 1e-9
STRUCTURES = ("joint", "cascaded", "direct", "baseline")


@dataclass(frozen=True)
class Mechanism:
    """What is left away, and where it stands in the sources."""

    variant: Variant
    files: tuple[str, ...] = ()  # folder/name below cpp/src and cpp/include/slipwise
    named: tuple[tuple[str, str], ...] = ()  # lines of shared files that a regular expression finds

    @property
    def lines(self) -> int:
        """Lines of its own files, and those of shared files that name it."""
        own = [path for name in self.files for path in _sources(name)]
        if self.files and not own:
            raise FileNotFoundError(f"no sources of {self.variant.name}: {', '.join(self.files)}")
        count = sum(len(path.read_text(encoding="utf-8").splitlines()) for path in own)
        for name, expression in self.named:
            lines = [
                line for path in _sources(name) for line in path.read_text(encoding="utf-8").splitlines()
            ]
            count += sum(re.search(expression, line) is not None for line in lines)
        return count


def _sources(name: str) -> list[Path]:
    places = (ROOT / f"cpp/include/slipwise/{name}.hpp", ROOT / f"cpp/src/{name}.cpp")
    return [path for path in places if path.exists()]


def _without(structure: str) -> dict[str, object]:
    return {"auto": {"structures": [name for name in STRUCTURES if name != structure]}}


_AVERAGE, _FILTER = "hypotheses.average.", "hypotheses.filter."
_BANK = "hypotheses/structures"
_ACTUATOR = (
    "filter/window_model",
    *(
        f"identify/{name}"
        for name in (
            "actuator_filter",
            "actuator_channel",
            "channel_run",
            "axis_window",
            "actuator_noise",
            "wheel_means",
        )
    ),
)
_ONE = "odd-even-10"  # of all bases, it is best most often

MECHANISMS = (
    Mechanism(
        Variant("cascaded structure", settings=_without("cascaded")),
        ("hypotheses/cascaded_model", "identify/channel_refit", *_ACTUATOR),
        ((_BANK, "[cC]ascade"),),
    ),
    Mechanism(Variant("direct structure", settings=_without("direct")), named=((_BANK, "[dD]irect"),)),
    Mechanism(Variant("baseline structure", settings=_without("baseline")), named=((_BANK, "[bB]aseline"),)),
    Mechanism(
        Variant("all structures but joint", settings={"auto": {"structures": ["joint"]}}),
        ("hypotheses/cascaded_model", "identify/channel_refit", _BANK, *_ACTUATOR),
    ),
    Mechanism(
        Variant(f"average of bases: {_ONE} alone", settings={"auto": {"bases": [_ONE]}}),
        ("hypotheses/model_average", "filter/weighting"),
    ),
    Mechanism(
        Variant(f"both: joint {_ONE} alone", settings={"auto": {"bases": [_ONE], "structures": ["joint"]}}),
    ),
    Mechanism(
        Variant("branches", settings={"change": {"branches": False}}),
        ("filter/branch_bank",),
        (("filter/causal_filter", r"[bB]ranch"),),
    ),
    Mechanism(
        Variant("slip disturbance", settings={"slip_disturbance": {"learn": False}}),
        (
            "disturbance/slip_disturbance",
            "disturbance/slip_deviation",
            "motion/disturbance_model",
            "online/recent_slip",
        ),
        (("online/motion_learner", r"disturbance|recent"),),
    ),
    Mechanism(
        Variant("refits of filters", constants={"causal_filter.kFirst": NEVER}),
        ("filter/filter_refit", "filter/batch"),
        (("filter/causal_filter", r"[rR]efit|kept_|full_|before_"),),
    ),
    Mechanism(
        Variant(
            "refits of the actuator",
            constants={"actuator_filter.kFirst": NEVER, "actuator_filter.kLast": NEVER},
        ),
        ("identify/channel_refit", "identify/channel_run"),
        (("identify/actuator_filter", r"[rR]efit|past_"),),
    ),
    Mechanism(
        Variant("slow mode of the actuator", numbers={f"{_FILTER}prior.slow_fraction_std": ALMOST_NONE})
    ),
    Mechanism(Variant("gain of the actuator", numbers={f"{_FILTER}prior.gain_std": ALMOST_NONE})),
    Mechanism(
        Variant("clock offset", settings={"learn_clock_offset": False}),
        named=((_BANK, "clock"), ("motion/motion_model", "[cC]lock")),
    ),
    Mechanism(Variant("fixed-share of bases", numbers={f"{_AVERAGE}weighting.fraction": ALMOST_NONE})),
    Mechanism(Variant("prior weight of the largest basis", numbers={f"{_AVERAGE}largest_basis": 0.5 / 1.2})),
    Mechanism(
        Variant("Huber weights", settings={"filter": {"huber": 1e6}}),
        named=(("filter/iekf", "[hH]uber"), ("filter/batch", "[hH]uber")),
    ),
    Mechanism(
        Variant("gate of outliers", numbers={f"{_FILTER}iekf.gate": NEVER}),
        named=(("filter/iekf", r"\bgate"),),
    ),
    Mechanism(
        Variant("learning of noise", settings={"noise": {"adapt": False}}),
        ("filter/noise_scale",),
        (("filter/causal_filter", "noise_scale"),),
    ),
    Mechanism(
        Variant(
            "correlated scores",
            constants={"score_covariance.kModelSegments": NEVER, "score_covariance.kKernelTime": ALMOST_NONE},
        ),
        ("filter/score_covariance",),
        (("filter/causal_filter", "reported|scores"),),
    ),
)
CALIBRATION = Mechanism(Variant(), ("online/student_calibration", "online/student_t"))
LIMITS = Mechanism(
    Variant("default, then limits", limits=True),
    (
        "online/actuator_limits",
        "identify/limit_search",
        "identify/limited_actuator_fit",
        "identify/limited_actuator_parameters",
        "identify/dead_band_search",
    ),
)
