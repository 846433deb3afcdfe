"""Worlds with lasers, a mapper that learns where a place changes, and a learning task.

>>> import curious
>>> fleet = curious.Fleet("four_rooms", seed=7)
>>> fleet.step([[0.5, 0.0]], steps=20)
>>> fleet.look(0).ranges.shape
(720,)

Units are SI: meters, seconds, radians. Poses are ``[x, y, heading]``. Arrays of cells have the shape (rows, columns),
and row 0 has the lowest y. The same world, seed and commands give the same bits as in Rust.

Where Gymnasium is installed, the environment of :mod:`curious.envs` is registered as ``curious/Drive-v0``.
"""

from ._native import (
    Batch,
    Estimate,
    Fleet,
    Localizer,
    Log,
    Mapper,
    Output,
    Reading,
    Situation,
    SnapshotError,
    Spec,
    World,
    WorldError,
    __version__,
    strategies,
    trial,
)

__all__ = [
    "Batch",
    "Estimate",
    "Fleet",
    "Localizer",
    "Log",
    "Mapper",
    "Output",
    "Reading",
    "Situation",
    "SnapshotError",
    "Spec",
    "World",
    "WorldError",
    "__version__",
    "strategies",
    "trial",
]


def _register() -> None:
    try:
        import gymnasium
    except ImportError:
        return
    gymnasium.register(
        id="curious/Drive-v0",
        entry_point="curious.envs:DriveEnv",
        vector_entry_point="curious.envs:DriveVectorEnv",
    )


_register()
