# SPDX-License-Identifier: Apache-2.0
"""slipwise learns a ground robot's motion model while the robot drives."""
