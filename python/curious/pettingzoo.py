"""Driving with several robots in one world, with PettingZoo's parallel interface.

>>> from curious.pettingzoo import DriveParallelEnv
>>> env = DriveParallelEnv("my_fleet.toml")
>>> observations, infos = env.reset(seed=1)

Every driven robot of the world is an agent with a goal of its own; observations, actions and rewards are those of
``curious.envs.DriveEnv``. The driven robots must have lasers with the same number of beams. An agent at its goal leaves,
and its robot stands there.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from pettingzoo import ParallelEnv

from ._native import Batch, Spec
from .envs import _actions, _draw, _world_seed

__all__ = ["DriveParallelEnv"]


class DriveParallelEnv(ParallelEnv):
    """A fleet that drives to goals. ``world``: a ``Spec``, a name or a path. Settings: those of ``DriveEnv``."""

    metadata = {"render_modes": ["rgb_array"], "name": "curious_drive_v0", "render_fps": 10}

    def __init__(self, world: Any, render_mode: str | None = None, render_size: int = 480, **settings: Any) -> None:
        spec = world if isinstance(world, Spec) else Spec.load(world)
        self._batch: Batch | None = Batch.drive(spec, 1, 1, **settings)
        self._batch.autoreset = False
        names = spec.robots
        self.possible_agents = [names[index] for index in spec.driven]
        self.agents: list[str] = []
        self.render_mode = render_mode
        self.render_size = render_size
        self._names = self._batch.info_names
        space = spaces.Box(-1.0, 1.0, (self._batch.observation_len,), np.float32)
        self.observation_spaces = {agent: space for agent in self.possible_agents}
        self.action_spaces = {agent: spaces.Box(-1.0, 1.0, (2,), np.float32) for agent in self.possible_agents}
        self._random = seeding.np_random(None)[0]
        self._world_seed = 0
        self._no_seeds = np.zeros(1, np.uint64)

    def observation_space(self, agent: str) -> spaces.Space:
        """The space of the observations of an agent."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Space:
        """The space of the actions of an agent."""
        return self.action_spaces[agent]

    @property
    def batch(self) -> Batch:
        """The native part. ``ClosedEnvironmentError`` after ``close``."""
        if self._batch is None:
            raise gymnasium.error.ClosedEnvironmentError("the environment is closed: make a new one")
        return self._batch

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, np.ndarray], dict[str, dict[str, Any]]]:
        """Begin an episode with all agents."""
        if seed is not None:
            self._random = seeding.np_random(seed)[0]
        self._world_seed = _draw(self._random)
        if options and "world_seed" in options:
            self._world_seed = _world_seed(options["world_seed"])
        rows = self.batch.reset(np.array([self._world_seed], np.uint64))
        self.agents = list(self.possible_agents)
        return dict(zip(self.agents, rows)), dict(zip(self.agents, self._infos(self.batch.info())))

    def _infos(self, values: np.ndarray) -> list[dict[str, Any]]:
        """Return the info of every agent from its row of values."""
        return [dict(zip(self._names, row), world_seed=self._world_seed) for row in values.tolist()]

    def step(self, actions: dict[str, Any]) -> tuple[dict, dict, dict, dict, dict]:
        """Simulate one step. ``actions`` has one for every present agent."""
        missing = [agent for agent in self.agents if agent not in actions]
        if missing:
            raise ValueError(f"there is no action for {', '.join(missing)}")
        array = np.zeros((len(self.possible_agents), 2), np.float32)
        for row, agent in enumerate(self.possible_agents):
            if agent in self.agents:
                try:
                    array[row] = _actions(actions[agent], 1)[0]
                except (ValueError, TypeError) as error:
                    raise type(error)(f"{agent}: {error}") from None
                for value in array[row]:
                    # Not NaN, and rounding may add a little.
                    if not abs(value) <= 1.0 + 1e-6:
                        raise ValueError(f"{agent}: action {value} is not from -1 to 1")
        rows, rewards, terminated, truncated, values, _, _ = self.batch.step(array, self._no_seeds)
        infos = self._infos(values)
        results: tuple[dict, dict, dict, dict, dict] = ({}, {}, {}, {}, {})
        for row, agent in enumerate(self.possible_agents):
            if agent in self.agents:
                of_agent = (rows[row], float(rewards[row]), bool(terminated[row]), bool(truncated[row]), infos[row])
                for result, value in zip(results, of_agent):
                    result[agent] = value
        self.agents = [agent for agent in self.agents if not (results[2][agent] or results[3][agent])]
        return results

    def render(self) -> np.ndarray | None:
        """The world from above, shape (rows, columns, 3), uint8."""
        if self.render_mode is None:
            gymnasium.logger.warn("render() needs render_mode='rgb_array' when the environment is made")
            return None
        return self.batch.picture(0, self.render_size)

    def close(self) -> None:
        """Free everything. A closed environment cannot be used."""
        self._batch = None
