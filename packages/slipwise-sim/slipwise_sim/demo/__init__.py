# SPDX-License-Identifier: Apache-2.0
"""The demonstration: from a simulated drive to a model, scores and a report."""

from slipwise_sim.demo.run_demo import DemoOptions, DemoResult, run_demo

__all__ = ["DemoOptions", "DemoResult", "run_demo"]
