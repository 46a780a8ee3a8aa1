# SPDX-License-Identifier: Apache-2.0
"""What carries ROS messages: rclpy, Cyclone DDS."""
