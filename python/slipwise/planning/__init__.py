# SPDX-License-Identifier: Apache-2.0
"""For planners: many command sequences rolled out through a learned model at once."""

from slipwise.planning.costmap import Costmap
from slipwise.planning.futures import sample_futures
from slipwise.planning.rollout import Rollouts, command_buffer, rollout
from slipwise.planning.start import Start

__all__ = ["Costmap", "Rollouts", "Start", "command_buffer", "rollout", "sample_futures"]
