# SPDX-License-Identifier: Apache-2.0
"""The drive that teaches most: held commands that make the worst prediction as sure as they can."""

from slipwise.excitation.command_space import CommandSpace
from slipwise.excitation.command_table import command_inputs, write_command_bag, write_commands
from slipwise.excitation.design import Excitation, ExcitationOptions, design_drive
from slipwise.excitation.knowledge import Knowledge, knowledge_of, prior_knowledge
from slipwise.excitation.lessons import Lesson, lessons_of
from slipwise.excitation.moves import Move
from slipwise.excitation.next_moves import NextMove, NextMoves, choose_next_moves
from slipwise.excitation.robots import drawn_robots
from slipwise.excitation.vehicles import VEHICLES, Vehicle, vehicle_named

__all__ = [
    "VEHICLES",
    "CommandSpace",
    "Excitation",
    "ExcitationOptions",
    "Knowledge",
    "Lesson",
    "Move",
    "NextMove",
    "NextMoves",
    "Vehicle",
    "choose_next_moves",
    "command_inputs",
    "design_drive",
    "drawn_robots",
    "knowledge_of",
    "lessons_of",
    "prior_knowledge",
    "vehicle_named",
    "write_command_bag",
    "write_commands",
]
