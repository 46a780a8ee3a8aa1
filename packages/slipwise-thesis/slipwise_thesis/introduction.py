# SPDX-License-Identifier: Apache-2.0
"""What stands on top of both documents."""

TITLE = "The thesis, made again"
INTRODUCTION = (
    "The figures and tables of F. Rogers-Marcovitz, On-Line Mobile Robotic Dynamic Modeling Using Integrated "
    "Perturbative Dynamics (CMU-RI-TR-10-15, 2010), made again by the command slipwise reproduce thesis from "
    "simulated drives and real logs. The thesis's own logs are not published, so its numbers cannot be met; "
    "each says what agrees all the same, what differs and why."
)
