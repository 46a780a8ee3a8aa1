# SPDX-License-Identifier: Apache-2.0
"""Judging motion models on windows that they had not learned from."""

from slipwise.evaluation.compare_models import ModelComparison, compare_models
from slipwise.evaluation.evaluate import EvaluationOptions, evaluate
from slipwise.evaluation.prediction_file import write_predictions, write_sequence
from slipwise.evaluation.result import Evaluation, Score
from slipwise.evaluation.score_predictions import score_predictions
from slipwise.evaluation.sequence import SequenceEvaluation, evaluate_sequence
from slipwise.evaluation.simpler import proposing, simpler_method

__all__ = [
    "Evaluation",
    "EvaluationOptions",
    "ModelComparison",
    "Score",
    "SequenceEvaluation",
    "compare_models",
    "evaluate",
    "evaluate_sequence",
    "proposing",
    "score_predictions",
    "simpler_method",
    "write_predictions",
    "write_sequence",
]
