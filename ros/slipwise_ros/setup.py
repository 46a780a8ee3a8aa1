# SPDX-License-Identifier: Apache-2.0
"""Installs slipwise's live node as a ROS 2 package."""

from setuptools import setup

NAME = "slipwise_ros"

setup(
    name=NAME,
    version="0.2.0",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/launch", ["launch/live.launch.xml"]),
        (f"share/{NAME}/layouts", ["layouts/slipwise.json"]),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="The slipwise developers",
    maintainer_email="slipwise@example.com",
    description="Learns a robot's motion model while it drives.",
    license="Apache-2.0",
    entry_points={"console_scripts": [f"live = {NAME}.live:main"]},
)
