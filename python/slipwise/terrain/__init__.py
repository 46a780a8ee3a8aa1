# SPDX-License-Identifier: Apache-2.0
"""Names the surface under a robot by what its IMU and its motor currents feel, or says that it is unknown."""

from slipwise.terrain.classifier import UNKNOWN, Answer, TerrainClassifier
from slipwise.terrain.label_file import read_labels, write_labels
from slipwise.terrain.recordings import Recording, Stream, read_recordings
from slipwise.terrain.scores import Score, score_of
from slipwise.terrain.terrain_file import load_classifier, save_classifier
from slipwise.terrain.train import Training, train
from slipwise.terrain.watch import TerrainWatch, TerrainWindow
from slipwise.terrain.windows import Windows, cut_windows

__all__ = [
    "UNKNOWN",
    "Answer",
    "Recording",
    "Score",
    "Stream",
    "TerrainClassifier",
    "TerrainWatch",
    "TerrainWindow",
    "Training",
    "Windows",
    "cut_windows",
    "load_classifier",
    "read_labels",
    "read_recordings",
    "save_classifier",
    "score_of",
    "train",
    "write_labels",
]
