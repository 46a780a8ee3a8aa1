# SPDX-License-Identifier: Apache-2.0
"""Learning while the robot drives: samples in, the learner, results out."""
