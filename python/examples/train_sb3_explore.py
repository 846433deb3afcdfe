"""DQN of Stable-Baselines3 learns where to go in houses that change: `pip install stable-baselines3`.

The task is `curious/ExploreGoals-v0` with 24 proposed goals and what the whole way to each of them promises (`shows_routes`). The
test is that of `train_explore.py`. Three things differ from the defaults of DQN (Mnih et al., 2015):

- One network values each proposed goal by what it promises, with the same weights for all goals: what is learned from one goal
  holds for the others, and for goals in other houses.
- Two networks learn side by side, one per core, which look ahead differently far (`GAMMAS`). Their values are averaged: rewards are
  so noisy that one network has learned much that is chance.
- A step takes up to 45 s, so that the reward of a step says little. The learner is paid R - rho T in place of the reward R, where
  T is the time of the step and rho the mean reward per second so far (the average-reward criterion: Schwartz, 1993).

    python train_sb3_explore.py --steps 6000 --houses 200 --picture curve.png
"""

import argparse
import time
from concurrent.futures import ProcessPoolExecutor
from itertools import repeat
from multiprocessing import get_context
from typing import Any

import numpy as np
import torch
from curious.envs import ExploreGoalsVectorEnv
from curious.sb3 import SB3VecEnv
from stable_baselines3 import DQN
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnvWrapper
from stable_baselines3.dqn.policies import MultiInputPolicy, QNetwork
from train_explore import Progress, add_arguments, report

ENVS, HIDDEN = 8, 32
#: Many goals to choose from: most of them are drawn at random.
KINDS = {"random": 16, "predicted-change": 3, "recency": 2, "poisson": 2, "frontier": 1}
SETTINGS: dict[str, Any] = {"strategies": [name for name, count in KINDS.items() for _ in range(count)], "shows_routes": True}
#: The length of an episode, s: the observation has the share that is left.
EPISODE_S = 300.0
#: The rewards are divided by this: the network expects values of about 1.
SCALE = 10.0
#: A goal is worth what it earns, and this share of what the next one is worth.
GAMMAS = (0.5, 0.8)


class Values(torch.nn.Module):
    """The value of each goal, by what it promises, the kind of its strategy and the time left; not by the place in the house."""

    def __init__(self, space: Any) -> None:
        super().__init__()
        self.shapes = {name: part.shape for name, part in space.spaces.items()}
        kinds = list(KINDS)
        self.register_buffer("kinds", torch.eye(len(kinds))[[kinds.index(name) for name in SETTINGS["strategies"]]])
        self.net = torch.nn.Sequential(torch.nn.Linear(21, HIDDEN), torch.nn.Tanh(), torch.nn.Linear(HIDDEN, 1))

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        parts, begin = {}, 0
        for name, shape in self.shapes.items():
            end = begin + int(np.prod(shape))
            parts[name], begin = x[:, begin:end].view(-1, *shape), end
        goals, routes, state = parts["candidates"], parts["routes"], parts["state"]
        many = goals.shape[:2]
        # The unseen and the stale area per second, m²/s: the shares of `routes` turned back.
        travel_s = 60.0 * routes[..., 0:1] + 5.0
        unseen, stale = (half * share / (1.01 - share) for half, share in ((5.0, routes[..., 2:3]), (20.0, routes[..., 3:4])))
        # Distance, unseen and known area, in view, same; time left and known share of the map.
        chosen, shared = goals[..., [1, 2, 3, 7, 8]], state[:, None, 4:6].expand(*many, -1)
        kinds = self.kinds.expand(len(x), -1, -1)
        return self.net(torch.cat([chosen, routes, kinds, shared, unseen / travel_s, stale / travel_s], dim=2)).squeeze(2)


class GoalPolicy(MultiInputPolicy):
    """The policy of DQN for dictionaries, with `Values` as its network."""

    def make_q_net(self) -> QNetwork:
        net = super().make_q_net()
        net.q_net = Values(self.observation_space).to(self.device)
        return net


class AverageReward(VecEnvWrapper):
    """Pays R - rho T, divided by `SCALE`."""

    def __init__(self, env: SB3VecEnv) -> None:
        super().__init__(env)
        self.time_left = env.env.slices["state"]["time_left"].start
        self.earned, self.spent_s = 0.0, 1e-9
        self.left = np.ones(env.num_envs)

    def reset(self) -> Any:
        self.left[:] = 1.0
        return self.venv.reset()

    def step_wait(self) -> Any:
        observations, rewards, dones, infos = self.venv.step_wait()
        left = observations["state"][:, self.time_left].astype(float)
        for index in np.flatnonzero(dones):
            left[index] = infos[index]["terminal_observation"]["state"][self.time_left]
        self.times = (self.left - left) * EPISODE_S
        self.left = np.where(dones, 1.0, left)
        self.rewards = rewards
        # The mean reward per second forgets the first, worse choices.
        self.earned, self.spent_s = 0.998 * self.earned + rewards.sum(), 0.998 * self.spent_s + self.times.sum()
        return observations, (rewards - self.earned / self.spent_s * self.times) / SCALE, dones, infos


class Curve(BaseCallback):
    """Notes the reward of every episode, and prints a line every ten seconds."""

    def __init__(self, env: AverageReward) -> None:
        super().__init__()
        self.env = env
        self.progress = Progress()
        self.episodes: list[tuple[float, float]] = []

    def _on_step(self) -> bool:
        returns = [info["episode"]["r"] for info in self.locals["infos"] if "episode" in info]
        self.episodes += [(self.progress.minutes(), total) for total in returns]
        self.progress.note(self.env.rewards, self.env.times, self.num_timesteps, len(self.episodes))
        return True


def train(gamma: float, steps: int, seed: int) -> list[tuple[float, float]]:
    """Saves the learned model. Returns (minutes, reward of the task) of every episode."""
    # The network is small: with more threads they wait for each other.
    torch.set_num_threads(1)
    env = AverageReward(SB3VecEnv(ExploreGoalsVectorEnv(ENVS, threads=1, **SETTINGS)))
    model = DQN(
        GoalPolicy,
        env,
        learning_rate=1e-3,
        buffer_size=20_000,
        learning_starts=256,
        batch_size=256,
        gamma=gamma,
        train_freq=1,
        gradient_steps=ENVS // 2,
        target_update_interval=200,
        exploration_fraction=0.4,
        exploration_final_eps=0.05,
        policy_kwargs={"optimizer_class": torch.optim.AdamW, "optimizer_kwargs": {"weight_decay": 0.01}},
        seed=seed,
        device="cpu",
    )
    curve, begin = Curve(env), time.process_time()
    model.learn(steps, callback=curve)
    minutes, cpu_minutes = curve.progress.minutes(), (time.process_time() - begin) / 60.0
    print(f"{model.num_timesteps:,} goals in {minutes:.1f} min, {cpu_minutes:.1f} CPU min", flush=True)
    env.close()
    model.save(f"explorer-{gamma}")
    return curve.episodes


class Greedy:
    """Takes the goal with the largest mean value of the saved models."""

    def __init__(self) -> None:
        self.models = [DQN.load(f"explorer-{gamma}", device="cpu") for gamma in GAMMAS]

    def __call__(self, observation: dict[str, np.ndarray]) -> np.ndarray:
        with torch.no_grad():
            values = [model.q_net(model.policy.obs_to_tensor(observation)[0]) for model in self.models]
        return torch.stack(values).mean(dim=0).argmax(dim=1).numpy()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=6_000, help="goals that each network chooses; 0: the saved ones are tested")
    add_arguments(parser, houses=200)
    arguments = parser.parse_args()
    if arguments.steps > 0:
        with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
            curves = list(pool.map(train, GAMMAS, repeat(arguments.steps), repeat(arguments.seed)))
    else:
        curves = []
    report(Greedy(), sorted(episode for curve in curves for episode in curve), arguments, SETTINGS)


if __name__ == "__main__":
    main()
