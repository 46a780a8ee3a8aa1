# SPDX-License-Identifier: Apache-2.0
"""Learning the parameters of a user's own dynamics: boats, blimps, trailers, whatever has a state."""

from slipwise.dynamics.dynamics import Dynamics, Parameter, State
from slipwise.dynamics.learn_dynamics import learn_dynamics
from slipwise.dynamics.learned_dynamics import DynamicsPath, DynamicsScore, LearnedDynamics, LearnedParameter
from slipwise.dynamics.saved_dynamics import load_dynamics

__all__ = [
    "Dynamics",
    "DynamicsPath",
    "DynamicsScore",
    "LearnedDynamics",
    "LearnedParameter",
    "Parameter",
    "State",
    "learn_dynamics",
    "load_dynamics",
]
