# SPDX-License-Identifier: Apache-2.0
"""What arrives of commands, in words."""

from __future__ import annotations

from slipwise.models.model import Model
from slipwise.models.schema import AxisShares, Share
from slipwise.number_text import DASH, estimate_text, list_text, number_text

AXES = {"speed": ("speed", "m/s"), "yaw_rate": ("yaw rate", "rad/s")}
SHARE_HEAD = ("commanded", "at the body", "at the wheels", "of that on the floor")
_KNOWN = 0.15  # standard deviation up to which a share is said


def axis_shares(model: Model) -> dict[str, AxisShares]:
    """Return the shares by axis, "speed" and "yaw_rate", of those that the log says."""
    shares = model.content.shares
    found = {} if shares is None else {axis: getattr(shares, axis) for axis in AXES}
    return {axis: said for axis, said in found.items() if said is not None}


def share_sentences(model: Model) -> list[str]:
    """Say what arrives of commands over the log, and where it is not in proportion."""
    found = {axis: said for axis, said in axis_shares(model).items() if _known(said.arrives)}
    turn = AXES["yaw_rate"][0] if model.content.wheelbase is None else "turn"  # which steering commands
    names = {"speed": AXES["speed"][0], "yaw_rate": turn}
    parts = [_of_axis(said, names[axis]) for axis, said in found.items()]
    sentences = [f"Over this log, {' and '.join(parts)} arrive."] if parts else []
    apart = [text for axis, said in found.items() for text in _out_of_proportion(said, axis, names[axis])]
    if not apart:
        return sentences
    return [*sentences, f"That is no one number: {'; '.join(apart)}.", *_term_for_each_way(model, found)]


def _term_for_each_way(model: Model, found: dict[str, AxisShares]) -> list[str]:
    """Say which term learns one number for each way, where no limit of the drive explains two."""
    basis, limits = model.motion.basis, model.limits_section
    terms = {
        axis: f"{term} in terms.{place}"
        for axis, place, term in (("speed", "lon", "abs(V)"), ("yaw_rate", "ang", "abs(w)"))
        if axis in found
        and found[axis].backward is not None
        and term not in getattr(basis, place)
        and (limits is None or getattr(limits, axis).saturation is None)
    }
    if not terms or model.car is not None:
        return []
    return [f"A basis of yours with {list_text([*terms.values()], 'and')} learns one for each way."]


def _out_of_proportion(said: AxisShares, axis: str, name: str) -> list[str]:
    texts, unit = [], AXES[axis][1]
    if said.below is not None and said.small is not None and said.large is not None:
        size = f"{number_text(said.below, 2)} {unit}"
        texts.append(
            f"of {name}s commanded below {size} {percent(said.small)}, of larger ones {percent(said.large)}"
        )
    if said.backward is not None and said.forward is not None:
        ways = ("backward", "ahead") if axis == "speed" else ("to the right", "to the left")
        texts.append(
            f"of {name}s {ways[0]} {percent(said.backward)}, of those {ways[1]} {percent(said.forward)}"
        )
    return texts


def share_rows(model: Model) -> list[tuple[str, ...]]:
    """Return rows of a table with `SHARE_HEAD`; none where the log does not say what arrives."""
    return [
        (AXES[axis][0], *(DASH if each is None else percent(each) for each in (s.arrives, s.wheels, s.floor)))
        for axis, s in axis_shares(model).items()
    ]


def percent(share: Share) -> str:
    """Return a share in percent."""
    return f"{estimate_text(100.0 * share.value, 100.0 * share.std)} %"


def _of_axis(said: AxisShares, name: str) -> str:
    text = f"{percent(said.arrives)} of the commanded {name}"
    if said.wheels is None or said.floor is None or not (_known(said.wheels) and _known(said.floor)):
        return text
    return f"{text} (the wheels {percent(said.wheels)}, of that on the floor {percent(said.floor)})"


def _known(share: Share) -> bool:
    return share.std <= _KNOWN
