# SPDX-License-Identifier: Apache-2.0
"""Uses that write files for other tools: the numbers in them, held against the true robot."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matrix.learned import Learned

from slipwise.export import ExportOptions, export_model

WITHIN = 0.05  # of a number
LOGGED = {"ATC_STR_RAT_FF": 0.2, "CRUISE_SPEED": 1.0, "RO_MAX_THR_SPEED": 1.0}
OPTIONS = ExportOptions(
    ros_distro="lyrical", wheel_separation=0.5, px4="1.17", ardupilot="4.6", wheel_base=0.5, logged=LOGGED
)


def shares(learned: Learned) -> tuple[float, float]:
    """Return what comes of a speed and of a yaw rate on level ground, driven straight and in turns."""
    robot = learned.situation.exported
    turns = robot.slip["ang.w"] + 0.6 * robot.slip.get("ang.w*abs(V)", 0.0)  # at a usual speed
    return 1.0 + robot.slip["lon.V"], 1.0 + turns


def target(name: str, *truths: tuple[str, Callable[[Learned], float]]) -> Callable[[Learned], None]:
    """Return the use of a target: each number that it writes is finite, and these are the truth's."""

    def written(learned: Learned) -> None:
        exported = export_model(learned.model, name, name="model.yaml", options=OPTIONS, force=True)
        numbers = [value for value in exported.values.values() if isinstance(value, (int, float, list))]
        assert all(np.isfinite(np.asarray(value, dtype=float)).all() for value in numbers)
        assert exported.values or all(exported.kept.values()), "nothing is written, and nothing says why"
        for key, truth in truths:
            if key not in exported.values:
                assert exported.kept.get(key), f"{key} is not written, and nothing says why"
                continue
            found, wanted = float(exported.values[key]), truth(learned)  # type: ignore[arg-type]
            assert abs(found - wanted) <= WITHIN * abs(wanted), f"{key} is {found:.4g}, in truth {wanted:.4g}"

    written.__doc__ = f"The numbers for {name} are the truth's."
    return written


def speed(learned: Learned) -> float:
    """What comes of a speed."""
    return shares(learned)[0]


def separation(learned: Learned) -> float:
    """How much further apart the wheels of a robot without slip would stand."""
    straight, turned = shares(learned)
    return (1.0 if learned.situation.turns else straight) / turned


def late(axis: int) -> Callable[[Learned], float]:
    """Delay and lag together."""
    return lambda learned: learned.situation.robot.axes[axis].delay + learned.situation.robot.axes[axis].lag


TARGETS = {
    "diff-drive": target(
        "diff-drive", ("wheel_separation_multiplier", separation), ("left_wheel_radius_multiplier", speed)
    ),
    "mppi": target("mppi", ("FollowPath.model_delay_vx", late(0)), ("FollowPath.model_delay_wz", late(-1))),
    "amcl": target("amcl"),
    "robot-localization": target("robot-localization"),
    "autoware": target("autoware", ("speed_scale_factor", speed)),
    "px4": target("px4", ("RO_YAW_RATE_CORR", separation), ("RO_MAX_THR_SPEED", speed)),
    "ardupilot": target(
        "ardupilot",
        ("ATC_STR_RAT_FF", lambda learned: LOGGED["ATC_STR_RAT_FF"] / shares(learned)[1]),
        ("CRUISE_SPEED", speed),
    ),
}
