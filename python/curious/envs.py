"""Environments with Gymnasium's interface: one world, or many worlds that one call steps on several threads.

``DriveEnv`` and ``DriveVectorEnv``
    A robot drives to a goal among moving things. Observation, shape (beams + 7,), float32: the scan (0 to 1: share of
    the maximum range; 1 without a return), then distance to the goal (share of the diagonal of the world), cosine and
    sine of its direction, cosine and sine of the direction of the shortest path (as a global planner would give it),
    linear and angular velocity (shares of the maximum). Action, shape (2,), float32, from -1 to 1: linear and angular
    velocity as shares of the maximum. Reward: meters of the shortest path, 10 at the goal, -0.5 per collision, -0.01
    per step. The episode terminates at the goal, and is truncated after 400 steps of 0.1 s. With ``shows_memory=True``, 128
    more numbers follow, from 0 to 1: ``visited`` (64), how long the robot was in places around it in this episode, and ``seen``
    (64), which share of them it saw: at 0.5, 1, 1.75 and 3 m, in 16 directions each, counter-clockwise from behind.

``slices`` of an environment names the values of an observation: ``observation[env.slices["goal_direction"]]``.

``info["collisions"]`` counts the contacts of the episode that began while the robot moved.

Everything random comes from ``np_random``: ``reset`` draws the seed of the world from it, and ``info["world_seed"]`` has
it, so that Rust can repeat the episode. The vector environments reset an environment in the same step in which its
episode ends (``AutoresetMode.SAME_STEP``): ``info["final_obs"]`` keeps the last observation, ``info["final_info"]`` the
last information. An episode of environment ``i`` of a vector environment with seed ``s`` has the same bits as that of a
single environment with seed ``s + i``.
"""

from __future__ import annotations

import copy
import operator
from typing import Any, Sequence

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from ._native import Batch, Spec

__all__ = [
    "TEST_HOUSES",
    "TRAIN_HOUSES",
    "DriveEnv",
    "DriveVectorEnv",
]

#: Seeds of generated houses (``Spec.house``) to learn in, and to test in: no seed is in both.
TRAIN_HOUSES = range(100_000, 110_000)
TEST_HOUSES = range(1_000)


def _draw(random: np.random.Generator) -> int:
    """The seed of a world."""
    return int(random.integers(0, 1 << 63))


def _world_seed(value: Any) -> int:
    """A seed of a world that the caller has chosen."""
    seed = operator.index(value)
    if not 0 <= seed < 1 << 64:
        raise ValueError(f"the seed of a world is from 0 to 2^64 - 1, and not {seed}")
    return seed


def _observation_space(batch: Batch) -> spaces.Box:
    return spaces.Box(-1.0, 1.0, (batch.observation_len,), np.float32)


def _slices(batch: Batch) -> dict[str, slice]:
    """The named slices of an observation."""
    found, begin = {}, 0
    for name, length in batch.slices:
        found[name] = slice(begin, begin + length)
        begin += length
    return found


def _infos(names: Sequence[str], values: np.ndarray) -> dict[str, np.ndarray]:
    """The columns of the native information by name: the count of collisions as whole numbers."""
    columns: dict[str, np.ndarray] = {name: values[:, column] for column, name in enumerate(names)}
    return {**columns, "collisions": columns["collisions"].astype(np.int64)}


class _Native:
    """What one environment and many have in common: the native part, which one call steps."""

    metadata: dict[str, Any]

    def _open(
        self, num_envs: int, threads: int, render_mode: str | None, render_size: int, world: Any = None, **settings: Any
    ) -> None:
        if render_mode is not None and render_mode not in self.metadata["render_modes"]:
            raise ValueError(f"render_mode must be one of {self.metadata['render_modes']}, not {render_mode!r}")
        self.render_mode = render_mode
        self.render_size = render_size
        spec = Spec.driving_hall() if world is None else world
        self._batch: Batch | None = Batch.drive(spec, num_envs, threads, **settings)
        self._names = self._batch.info_names
        self.slices = _slices(self._batch)
        self._was_reset = False

    @property
    def batch(self) -> Batch:
        """The native part. ``ClosedEnvironmentError`` after ``close``."""
        if self._batch is None:
            raise gymnasium.error.ClosedEnvironmentError("the environment is closed: make a new one")
        return self._batch

    def __reduce_ex__(self, protocol: Any) -> Any:
        """For `pickle`, and for `copy.copy`, whose result would share the world."""
        raise TypeError(
            f"{type(self).__name__} cannot be pickled: make another one with the same settings, and give it `snapshot()` "
            "by `restore()`, as `copy.deepcopy` does"
        )


class DriveEnv(_Native, gymnasium.Env):
    """Driving to goals among moving things; see the module.

    ``world``: a ``Spec``, a name or a path, with one driven robot. Settings: ``decision_s``, ``max_steps``, ``goal_radius`` (m), ``min_goal`` (m), ``shows_path``,
    ``shows_memory``, ``goal_reward``, ``progress_reward``, ``collision_reward``, ``step_reward``.
    """

    metadata = {"render_modes": ["rgb_array", "human"], "render_fps": 10}

    def __init__(self, render_mode: str | None = None, render_size: int = 480, **settings: Any) -> None:
        for name in {"num_envs", "threads"} & settings.keys():
            raise TypeError(f"`{name}` is for many environments: make them with `gymnasium.make_vec`")
        self._open(1, 1, render_mode, render_size, **settings)
        self.batch.autoreset = False
        self._settings = settings
        self.observation_space = _observation_space(self.batch)
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        self._world_seed = 0
        self._screen: Any = None
        self._no_seeds = np.zeros(1, np.uint64)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begin an episode. ``options={"world_seed": n}`` repeats a world."""
        batch = self.batch
        super().reset(seed=seed)
        self._world_seed = _draw(self.np_random)
        if options and "world_seed" in options:
            self._world_seed = _world_seed(options["world_seed"])
        rows = batch.reset(np.array([self._world_seed], np.uint64))
        self._was_reset = True
        if self.render_mode == "human":
            self.render()
        return rows[0], self._info(batch.info())

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Simulate one step. ``ValueError``: the action has the wrong shape, is NaN or out of range."""
        actions = _actions(action, 1)
        rows, rewards, terminated, truncated, values, _, _ = self.batch.step(actions, self._no_seeds)
        info = self._info(values)
        if self.render_mode == "human":
            self.render()
        return rows[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), info

    def _info(self, values: np.ndarray) -> dict[str, Any]:
        info: dict[str, Any] = {name: column[0].item() for name, column in _infos(self._names, values).items()}
        info["world_seed"] = self._world_seed
        return info

    def render(self) -> np.ndarray | None:
        """The world from above: an array (``rgb_array``), or a window (``human``; needs ``pygame``)."""
        if self.render_mode is None:
            gymnasium.logger.warn("render() needs render_mode='rgb_array' or 'human' when the environment is made")
            return None
        picture = self.batch.picture(0, self.render_size)
        if self.render_mode == "rgb_array":
            return picture
        self._show(picture)
        return None

    def _show(self, picture: np.ndarray) -> None:
        try:
            import pygame
        except ImportError as error:
            raise gymnasium.error.DependencyNotInstalled("render_mode='human' needs `pip install pygame`") from error
        if self._screen is None:
            # Not `pygame.init()`: it opens the audio device as well.
            pygame.display.init()
            self._screen = pygame.display.set_mode((picture.shape[1], picture.shape[0]))
            pygame.display.set_caption(str(type(self).__name__))
        pygame.event.pump()
        self._screen.blit(pygame.surfarray.make_surface(np.swapaxes(picture, 0, 1)), (0, 0))
        pygame.display.flip()

    def snapshot(self) -> bytes:
        """The state of the world and of the task; not that of ``np_random``."""
        return self.batch.snapshot(0)

    def restore(self, snapshot: bytes, *, allow_other_build: bool = False) -> Any:
        """Return to a snapshot of an environment with the same settings; returns the observation."""
        restored = self.batch.restore(0, snapshot, allow_other_build=allow_other_build)
        self._world_seed = self.batch.seed(0)
        self._was_reset = True
        return restored[0]

    def __deepcopy__(self, memo: dict[int, Any]) -> Any:
        """Another environment in the same state, which goes on with the same bits; without the window."""
        snapshot = self.batch.snapshot(0) if self._was_reset else None
        other = type(self)(self.render_mode, self.render_size, **self._settings)
        memo[id(self)] = other
        other.spec = self.spec
        other._np_random, other._np_random_seed = copy.deepcopy(self._np_random, memo), self._np_random_seed
        if snapshot is not None:
            other.restore(snapshot)
        return other

    def close(self) -> None:
        """Free everything. A closed environment cannot be used."""
        self._batch = None
        if self._screen is not None:
            import pygame

            pygame.display.quit()
            self._screen = None


def _actions(actions: Any, rows: int) -> np.ndarray:
    """The actions as float32 of shape (rows, 2)."""
    array = np.asarray(actions)
    if array.dtype.kind not in "biuf":
        raise TypeError(f"actions are real numbers, and not {array.dtype} ({type(actions).__name__})")
    array = array.astype(np.float32, copy=False)
    if array.size != rows * 2 or array.shape[-1:] != (2,):
        expected = "(2,)" if rows == 1 else f"({rows}, 2)"
        raise ValueError(f"the actions have the shape {array.shape}, and must have {expected}")
    return array.reshape(rows, 2)


class DriveVectorEnv(_Native, gymnasium.vector.VectorEnv):
    """Many of ``DriveEnv``: one call steps all of them. ``threads``: 0 for all, 1 for none beside the caller."""

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10, "autoreset_mode": AutoresetMode.SAME_STEP}

    def __init__(
        self,
        num_envs: int = 1,
        threads: int = 0,
        render_mode: str | None = None,
        render_size: int = 240,
        **settings: Any,
    ) -> None:
        self._open(num_envs, threads, render_mode, render_size, **settings)
        self.num_envs = num_envs
        self._settings = {"threads": threads, **settings}
        self.single_observation_space = _observation_space(self.batch)
        self.single_action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._randoms = [seeding.np_random(None)[0] for _ in range(num_envs)]
        self._world_seeds = np.zeros(num_envs, np.uint64)
        self._next_seeds = np.zeros(num_envs, np.uint64)
        self._all = np.ones(num_envs, bool)
        # Every environment has every value.
        self._masks = {f"_{name}": self._all for name in [*self._names, "world_seed"]}

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode in every environment. With a number ``s``, environment ``i`` has the seed ``s + i``.

        ``options={"world_seed": seeds}``, one per environment, as in ``info["world_seed"]``, repeats worlds.
        """
        batch = self.batch
        if seed is not None:
            is_number = isinstance(seed, (int, np.integer))
            seeds = [seed + index for index in range(self.num_envs)] if is_number else seed
            if isinstance(seeds, (str, bytes)) or not hasattr(seeds, "__len__"):
                raise TypeError(f"a seed is a whole number or a list of them, and not {type(seed).__name__}")
            if len(seeds) != self.num_envs:
                raise ValueError(f"there are {len(seeds)} seeds for {self.num_envs} environments")
            for index, single in enumerate(seeds):
                if single is not None:
                    self._randoms[index] = seeding.np_random(single)[0]
        self._world_seeds = np.array([_draw(random) for random in self._randoms], np.uint64)
        self._next_seeds = np.array([_draw(random) for random in self._randoms], np.uint64)
        if options and "world_seed" in options:
            chosen = list(options["world_seed"])
            if len(chosen) != self.num_envs:
                raise ValueError(f"there are {len(chosen)} seeds of worlds for {self.num_envs} environments")
            self._world_seeds = np.array([_world_seed(value) for value in chosen], np.uint64)
        rows = batch.reset(self._world_seeds)
        self._was_reset = True
        info: dict[str, Any] = {**_infos(self._names, batch.info()), "world_seed": self._world_seeds.copy(), **self._masks}
        return rows, info

    def step(self, actions: Any) -> tuple[Any, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Simulate one step of every environment. ``ValueError``: an action is NaN or out of range."""
        rows, rewards, terminated, truncated, values, was_reset, last = self.batch.step(
            _actions(actions, self.num_envs), self._next_seeds
        )
        info: dict[str, Any] = dict(_infos(self._names, values))
        if last is not None:
            ended = np.flatnonzero(was_reset)
            final_obs = np.empty(self.num_envs, object)
            for index in ended:
                final_obs[index] = last[index]
            final_info: dict[str, Any] = {name: info[name].copy() for name in self._names}
            final_info["world_seed"] = self._world_seeds.copy()
            final_info.update({f"_{name}": was_reset.copy() for name in [*self._names, "world_seed"]})
            info.update(final_obs=final_obs, _final_obs=was_reset)
            info.update(final_info=final_info, _final_info=was_reset.copy())
            for index in ended:
                self._world_seeds[index] = self._next_seeds[index]
                self._next_seeds[index] = _draw(self._randoms[index])
        info["world_seed"] = self._world_seeds.copy()
        info.update(self._masks)
        return rows, rewards.astype(np.float64), terminated, truncated, info

    def render(self) -> tuple[np.ndarray, ...] | None:
        """The environments from above, one array each."""
        if self.render_mode is None:
            gymnasium.logger.warn("render() needs render_mode='rgb_array' when the environments are made")
            return None
        return tuple(self.batch.picture(index, self.render_size) for index in range(self.num_envs))

    def snapshot(self, index: int) -> bytes:
        """The state of one environment; not that of its random numbers for seeds."""
        return self.batch.snapshot(index)

    def restore(self, index: int, snapshot: bytes, *, allow_other_build: bool = False) -> Any:
        """Return one environment to a snapshot; returns its observation."""
        restored = self.batch.restore(index, snapshot, allow_other_build=allow_other_build)
        self._world_seeds[index] = self.batch.seed(index)
        return restored[0]

    def __deepcopy__(self, memo: dict[int, Any]) -> Any:
        """Other environments in the same states, which go on with the same bits."""
        snapshots = [self.batch.snapshot(index) for index in range(self.num_envs)] if self._was_reset else []
        keywords = {"render_mode": self.render_mode, "render_size": self.render_size, **self._settings}
        other = type(self)(self.num_envs, **keywords)
        memo[id(self)] = other
        other._randoms = copy.deepcopy(self._randoms, memo)
        other._world_seeds, other._next_seeds = self._world_seeds.copy(), self._next_seeds.copy()
        if snapshots:
            other.batch.reset(other._world_seeds)
            other._was_reset = True
        for index, snapshot in enumerate(snapshots):
            other.batch.restore(index, snapshot)
        return other

    def close_extras(self, **kwargs: Any) -> None:
        """Free everything."""
        self._batch = None
