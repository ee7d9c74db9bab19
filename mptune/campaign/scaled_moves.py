"""Manoeuvres with their length and their time multiplied."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mptune.params.manoeuvre import Manoeuvre


def scaled(move: Manoeuvre, distance: float, duration: float) -> Manoeuvre:
    """Return a manoeuvre with its length and time multiplied; its rest stays as it is."""
    samples = tuple(
        (time * duration, move.samples[0][1] + (place - move.samples[0][1]) * distance)
        for time, place in move.samples
    )
    values = {
        "distance": move.distance * distance,
        "speed": move.speed * distance / duration,
        "ramp": move.ramp * duration,
        "duration": move.duration * duration,
        "samples": samples,
    }
    return move.model_copy(update=values)
