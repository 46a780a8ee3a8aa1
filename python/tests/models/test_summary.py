# SPDX-License-Identifier: Apache-2.0
"""What a model has learned, in words: identified numbers alone, in physical units."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_models import LIMITS, Made, make_model, named

from slipwise import _core
from slipwise.models import Model, ModelFile
from slipwise.models.schema import Shares
from slipwise.models.share_words import share_sentences
from slipwise.models.summary import summarise


def judged(model: Model, *, good: bool = True, windows: int = 20) -> Model:
    """The model with held-out errors of 0.05 m and 0.02 rad, where the baseline has 0.55 m and 0.4 rad."""
    held_out = {"horizon": 5.0, "segments": windows, "position": 0.05, "heading": 0.02}
    held_out |= {"baseline_position": 0.55, "baseline_heading": 0.4}
    content = model.content.model_dump()
    content["verdict"] |= {"good": good, "held_out": held_out}
    return Model(ModelFile.model_validate(content))


def follower(std: float = 0.01, **values: float) -> Model:
    """A robot that turns 60 % of what is commanded, with 0.2 s of delay and 0.3 s of time constant."""
    made = named("edd-2", ang__w=-0.4, **values)
    return make_model(replace(made, commands=True, std=std))


def joined(model: Model) -> str:
    """What is said, one sentence after another."""
    return " ".join(summarise(model).sentences)


def test_a_good_model_is_said_in_physical_units() -> None:
    text = str(summarise(judged(follower())))
    assert "turns 60.0 ± 1.0 % of what is commanded." in text
    assert "after 0.200 ± 0.002 s and with a time constant of 0.300 ± 0.003 s (63 % of a step" in text
    assert "Predicts 5 s ahead to 0.0500 m and 0.0200 rad (1.15 deg), 11 and 20 times better" in text
    assert "log_" not in text


def test_a_delay_that_is_not_identified_is_not_said() -> None:
    summary = summarise(follower(std=0.5))
    assert "after" not in str(summary)
    assert "time constant" not in str(summary)
    table = {p.name: p for p in summary.parameters}
    assert not table["delay_v"].identified
    assert table["delay_v"].value == pytest.approx(0.2)
    assert table["delay_v"].std == pytest.approx(0.1)
    assert table["delay_v"].unit == "s"


def test_delays_without_an_actuator_model_are_said_without_a_time_constant() -> None:
    late = make_model(replace(named("edd-2", ang__w=-0.4), delays=(0.2, 0.2)))
    assert "Follows commands after 0.200 ± 0.010 s. How much of that is a lag is not known." in joined(late)
    apart = make_model(replace(named("edd-2", ang__w=-0.4), delays=(0.2, 0.001)))
    text = "Follows speed commands after 0.200 ± 0.010 s, and yaw-rate commands at once."
    assert f"{text} How much of that is a lag is not known." in joined(apart)
    quick = make_model(replace(named("edd-2", ang__w=-0.4), delays=(0.001, -0.002)))
    assert "Follows commands at once." in joined(quick)
    assert "is a lag" not in joined(quick)
    unknown = make_model(replace(named("edd-2", ang__w=-0.4), delays=(0.1, 0.1), std=0.2))
    assert "Follows" not in str(summarise(unknown))


def test_a_slip_that_is_not_identified_is_not_said() -> None:
    text = str(summarise(make_model(replace(named("edd-2", ang__w=-0.4), std=0.5))))
    assert text.startswith("The log does not identify how much the robot slips.")


def test_a_slip_known_to_be_negligible_is_identified_though_its_fraction_is_not() -> None:
    parameters = summarise(make_model(replace(named("edd-2", ang__w=0.001), std=0.01))).parameters
    assert {p.name: p.identified for p in parameters} == {"lon.V": True, "ang.w": True}


def test_what_the_range_of_the_log_does_not_show_is_not_identified() -> None:
    straight = replace(named("edd-2", lon__V=-0.1), yaw_rate=(0.0, 0.0))
    summary = summarise(make_model(straight))
    assert {p.name: p.identified for p in summary.parameters} == {"lon.V": True, "ang.w": False}
    assert "Drives 90.0 ± 1.0 % of what its wheels say." in summary.sentences


def test_channels_that_differ_are_said_apart() -> None:
    text = str(summarise(follower(log_delay_omega=float(np.log(0.5)))))
    assert "Follows speed commands after 0.200 ± 0.002 s" in text
    assert "and yaw-rate commands after 0.500 ± 0.005 s" in text


def test_channels_whose_lags_differ_beyond_their_spread_share_no_number() -> None:
    """0.300 and 0.276 s are near to each other, and each is known to 0.003 s."""
    text = str(summarise(follower(log_time_constant_omega=float(np.log(0.276)))))
    assert "Follows speed commands after 0.200 ± 0.002 s and with a time constant of 0.300 ± 0.003 s" in text
    assert "yaw-rate commands after 0.200 ± 0.002 s and with a time constant of 0.276 ± 0.003 s" in text
    hazy = str(summarise(follower(std=0.05, log_time_constant_omega=float(np.log(0.276)))))
    assert "Follows commands after " in hazy


def test_a_gain_of_the_actuator_is_told_from_slip() -> None:
    text = str(summarise(make_model(replace(named("edd-2", ang__w=-0.4), response=True))))
    assert "turns 60.0 ± 1.0 % of what its wheels say" in text
    assert "Its wheels reach 90.0 ± 1.0 % of the commanded speed" in text


def test_a_slow_mode_is_said_where_it_is_identified_and_hides_the_fast_one_where_it_is_not() -> None:
    clear = replace(named("edd-2"), response=True)
    text = str(summarise(make_model(clear)))
    assert "0.300 ± 0.003 s, 30.0 ± 1.0 % of it with a slower one of 1.500 ± 0.015 s (63 % of a step" in text
    hazy = replace(named("edd-2", slow_fraction_v=0.7, slow_fraction_omega=0.7), response=True, std=0.29)
    hidden = str(summarise(make_model(hazy)))
    assert "Follows commands after 0.20 ± 0.06 s at least." in hidden
    assert "time constant" not in hidden


def test_a_slow_mode_is_said_where_it_is_one_and_the_whole_lateness_whatever_the_modes_are() -> None:
    """A fraction below zero, or beside a lag as long, is no slower part of the answer."""
    for fraction in (-0.86, 1.4):
        values = {"slow_fraction_v": fraction, "slow_fraction_omega": fraction}
        text = str(summarise(make_model(replace(named("edd-2", **values), response=True, std=0.02))))
        assert "slower" not in text
        assert "63 % of a step after " in text
    values = {"slow_fraction_v": 0.3, "slow_fraction_omega": 0.3}
    text = str(summarise(make_model(replace(named("edd-2", **values), response=True, std=0.12))))
    assert "time constant" not in text
    late = 0.2 + 0.3 + 0.2  # delay, the fast lag, and more by the slow mode
    said = float(text.split("63 % of a step after ")[1].split(" ")[0])
    assert said == pytest.approx(late, abs=0.1)
    share = 100.0 * 0.9 * (0.7 * (1.0 - np.exp(-1.8 / 0.3)) + 0.3 * (1.0 - np.exp(-1.8 / 1.5)))
    assert f"2 s after a step, {share:.0f} ± " in text


def test_a_slow_mode_that_is_none_or_was_not_learned_is_not_said() -> None:
    tiny = {"slow_fraction_v": 0.0018, "slow_fraction_omega": 0.0018}
    text = str(summarise(make_model(replace(named("edd-2", **tiny), response=True, std=0.0005))))
    assert "with a time constant of 0.300" in text
    assert "slower" not in text
    learned = make_model(replace(named("edd-2"), response=True))
    assert "slower" in str(summarise(learned))
    content = learned.content.model_dump()
    content["verdict"]["not_identifiable"] = ["log_slow_time_constant_v", "log_slow_time_constant_omega"]
    assert "slower" not in str(summarise(Model(ModelFile.model_validate(content))))


def test_wheels_alone_tell_a_separation_multiplier() -> None:
    slip = named("edd-2", ang__w=-0.4)
    assert "(separation multiplier 1.67 ± 0.03)" in str(summarise(make_model(slip)))
    for commanded in ({"commands": True}, {"response": True}, {"delays": (0.2, 0.2)}):
        assert "multiplier" not in str(summarise(make_model(replace(slip, **commanded))))


def test_a_base_that_drives_sideways_says_how_far_and_has_no_separation_multiplier() -> None:
    basis = _core.Basis("sides", ["V", "Vy"], ["V", "Vy"], ["w"])
    slip = Made(basis, {"lon.V": -0.05, "lat.Vy": -0.2, "ang.w": -0.1}, std=0.002)
    model = make_model(slip)
    span = model.content.range.model_copy(update={"sideways": (-0.4, 0.5)})
    text = str(summarise(Model(model.content.model_copy(update={"range": span}))))
    assert (
        "Drives 95.00 ± 0.20 %, goes sideways 80.0 ± 0.2 % and turns 90.00 ± 0.20 % of what its wheels say."
        in text
    )
    assert "multiplier" not in text


def test_limits_offsets_and_the_place_of_the_sensor_are_said() -> None:
    made = replace(
        named("edd-2"),
        commands=True,
        clock_offset=0.1,
        limits=LIMITS,
        sensor_extrinsics=(-0.5, 0.2, 0.0),
        std=0.01,
    )
    text = str(summarise(make_model(made)))
    assert "Actuator limits of speed: dead band below 0.100 ± 0.010 m/s, at most 1.100 ± 0.010 m/s" in text
    late = "Poses come 0.100 ± 0.010 s later than wheel speeds of the same motion: they are stamped late, or "
    assert late + "the robot follows its wheels so much later (tracks, soft tyres)." in text
    assert "a fusion should shift stamps in the first case alone." in text
    early = str(summarise(make_model(replace(made, clock_offset=-0.1))))
    assert (
        "Wheel speeds are stamped 0.100 ± 0.010 s late, as no pose is stamped before it happens; delays in"
        in early
    )
    assert "follows its wheels so much later" not in early
    assert "The pose sensor sits 0.500 ± 0.010 m behind and 0.200 ± 0.010 m left of base_link." in text
    assert "turned" not in text


def test_a_model_that_is_not_good_is_not_called_better() -> None:
    text = str(summarise(judged(follower(), good=False)))
    assert "better" not in text
    assert "where the kinematic baseline misses by 0.550 m and 0.400 rad (22.9 deg)" in text


def test_what_was_not_judged_or_learned_is_not_claimed() -> None:
    nothing = Made(basis=_core.Basis("none", [], [], []))
    assert str(summarise(make_model(nothing))) == "Slip is not part of this model."
    assert "Predicts" not in str(summarise(judged(follower(), windows=0)))


def test_a_term_is_named_that_learns_one_number_for_each_way() -> None:
    """A robot that does 95 % ahead and 70 % backward is predicted 7 times as well with it."""
    share, back = {"value": 0.95, "std": 0.01}, {"value": 0.7, "std": 0.02}
    axis = {"windows": 99, "arrives": share, "backward": back, "forward": share}
    ways = Shares.model_validate({"speed": axis, "yaw_rate": axis})

    def said(made: Made) -> str:
        model = make_model(made)
        return " ".join(share_sentences(Model(model.content.model_copy(update={"shares": ways}))))

    plain = replace(named("edd-2"), commands=True)
    both = "A basis of yours with abs(V) in terms.lon and abs(w) in terms.ang learns one for each way."
    assert both in said(plain)
    capped = replace(plain, limits={"speed": {"saturation": 1.0}})
    assert "A basis of yours with abs(w) in terms.ang learns one for each way." in said(capped)
    own = Made(_core.Basis("custom", ["V", "abs(V)"], [], ["w", "abs(w)"]), commands=True)
    assert "A basis of yours" not in said(own)
