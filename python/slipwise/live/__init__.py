# SPDX-License-Identifier: Apache-2.0
"""Learning while the robot drives: what arrives, what is learned of it, and what others get."""
