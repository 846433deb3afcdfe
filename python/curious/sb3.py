"""The vector environments as those of Stable-Baselines3.

>>> from stable_baselines3 import PPO
>>> from curious.envs import DriveVectorEnv
>>> from curious.sb3 import SB3VecEnv
>>> model = PPO("MlpPolicy", SB3VecEnv(DriveVectorEnv(num_envs=64)))
"""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import VecEnv

__all__ = ["SB3VecEnv"]


class SB3VecEnv(VecEnv):
    """A vector environment of ``curious.envs`` for Stable-Baselines3. One call steps all worlds in native threads."""

    def __init__(self, env: Any) -> None:
        self.env = env
        self.render_mode = env.render_mode
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)
        self._actions: np.ndarray | None = None
        self._returns = np.zeros(env.num_envs)
        self._lengths = np.zeros(env.num_envs, np.int64)

    def reset(self) -> Any:
        """Begin an episode in every environment, with the seeds of ``seed``."""
        seeds = self._seeds if any(seed is not None for seed in self._seeds) else None
        observations, info = self.env.reset(seed=seeds)
        self.reset_infos = [{"world_seed": int(seed)} for seed in info["world_seed"]]
        self._reset_seeds()
        self._reset_options()
        self._returns[:] = 0.0
        self._lengths[:] = 0
        return observations

    def step_async(self, actions: np.ndarray) -> None:
        """Keep the actions for ``step_wait``."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Simulate one step. ``infos`` of an episode that ended have its last observation, its return and its length."""
        if self._actions is None:
            raise RuntimeError("call step_async() before step_wait()")
        observations, rewards, terminated, truncated, info = self.env.step(self._actions)
        self._actions = None
        self._returns += rewards
        self._lengths += 1
        dones = terminated | truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for index in np.flatnonzero(dones):
            final = {name: values[index] for name, values in info["final_info"].items() if not name.startswith("_")}
            infos[index] = {
                **final,
                "terminal_observation": info["final_obs"][index],
                "TimeLimit.truncated": bool(truncated[index] and not terminated[index]),
                "episode": {"r": float(self._returns[index]), "l": int(self._lengths[index]), "t": 0.0},
            }
            self._returns[index] = 0.0
            self._lengths[index] = 0
        return observations, rewards.astype(np.float32), dones, infos

    def close(self) -> None:
        """Free everything."""
        self.env.close()

    def get_images(self) -> Sequence[np.ndarray | None]:
        """The environments from above."""
        return self.env.render() or [None] * self.num_envs

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """An attribute of the vector environment, once per environment."""
        return [getattr(self.env, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Not possible: the environments share one native object."""
        raise NotImplementedError("the environments share one native object: set the attribute of `env`")

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        """Call a method of the vector environment with the index of each environment first."""
        return [getattr(self.env, method_name)(index, *args, **kwargs) for index in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """No environment is wrapped; but ``infos`` have what ``Monitor`` adds, the return and length of episodes."""
        return [wrapper_class is Monitor for _ in self._get_indices(indices)]
