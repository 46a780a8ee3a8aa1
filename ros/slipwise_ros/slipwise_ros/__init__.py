# SPDX-License-Identifier: Apache-2.0
"""slipwise's live node as a ROS 2 package."""
