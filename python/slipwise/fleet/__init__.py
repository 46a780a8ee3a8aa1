# SPDX-License-Identifier: Apache-2.0
"""Many logs of many robots: each learned once, kept as rows, and what the fleet knows together."""

from slipwise.fleet.empirical_bayes import FleetPrior, fleet_prior
from slipwise.fleet.find_logs import LogTask, find_logs
from slipwise.fleet.findings import Finding, ParameterFindings, findings_of
from slipwise.fleet.learned_rows import LogRows, learn_task
from slipwise.fleet.process_scheduler import Outcome, ProcessScheduler, Scheduler
from slipwise.fleet.start_prior import write_prior
from slipwise.fleet.store import Row, Store

__all__ = [
    "Finding",
    "FleetPrior",
    "LogRows",
    "LogTask",
    "Outcome",
    "ParameterFindings",
    "ProcessScheduler",
    "Row",
    "Scheduler",
    "Store",
    "find_logs",
    "findings_of",
    "fleet_prior",
    "learn_task",
    "write_prior",
]
