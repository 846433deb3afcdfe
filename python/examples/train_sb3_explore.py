"""DQN of Stable-Baselines3 learns where to go in houses that change: `pip install stable-baselines3`.

The task is `curious/ExploreGoals-v0`, and the test is that of `train_explore.py`. Two things differ from the defaults of DQN
(Mnih et al., 2015):

- One network values each proposed goal by what it promises, with the same weights for all goals: what is learned from one goal
  holds for the others.
- A step takes up to 45 s, so that the reward of a step says little. The learner is paid R - rho T in place of the reward R, where
  T is the time of the step and rho the mean reward per second so far (the average-reward criterion: Schwartz, 1993).

    python train_sb3_explore.py --steps 4000 --houses 100 --picture curve.png
"""

import argparse
import time
from typing import Any

import numpy as np
import torch
from curious.envs import ExploreGoalsVectorEnv
from curious.sb3 import SB3VecEnv
from stable_baselines3 import DQN
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnvWrapper
from stable_baselines3.dqn.policies import MultiInputPolicy, QNetwork
from train_explore import STRATEGIES, Progress, add_arguments, report

ENVS, HIDDEN = 8, 64
#: The length of an episode, s: the observation has the share that is left.
EPISODE_S = 300.0
#: The rewards are divided by this: the network expects values of about 1.
SCALE = 10.0
#: A goal is worth what it earns, and half of what the next one earns.
GAMMA = 0.5


class Values(torch.nn.Module):
    """The value of each goal, by its features, its strategy and the state of the map; not by the place in the house."""

    def __init__(self, goals: int, features: int, state: int) -> None:
        super().__init__()
        self.shape = goals, features
        self.net = torch.nn.Sequential(
            torch.nn.Linear(features + goals + state - 4, HIDDEN), torch.nn.Tanh(), torch.nn.Linear(HIDDEN, 1)
        )

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        (goals, features), rows = self.shape, len(x)
        candidates = x[:, : goals * features].view(rows, goals, features)
        names = torch.eye(goals).expand(rows, goals, goals)
        # Without position and heading, the first four values.
        state = x[:, None, goals * features + 4 :].expand(rows, goals, -1)
        return self.net(torch.cat([candidates, names, state], dim=2)).squeeze(2)


class GoalPolicy(MultiInputPolicy):
    """The policy of DQN for dictionaries, with `Values` as its network."""

    def make_q_net(self) -> QNetwork:
        net = super().make_q_net()
        space: Any = self.observation_space
        net.q_net = Values(*space["candidates"].shape, *space["state"].shape).to(self.device)
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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=4_000, help="goals chosen while learning: %(default)s")
    add_arguments(parser, houses=100)
    arguments = parser.parse_args()
    # The network is small: with more threads they wait for each other.
    torch.set_num_threads(1)
    env = AverageReward(SB3VecEnv(ExploreGoalsVectorEnv(ENVS, threads=1, strategies=STRATEGIES)))
    model = DQN(
        GoalPolicy,
        env,
        learning_rate=1e-3,
        buffer_size=20_000,
        learning_starts=256,
        batch_size=256,
        gamma=GAMMA,
        train_freq=1,
        gradient_steps=ENVS,
        target_update_interval=200,
        exploration_fraction=0.4,
        exploration_final_eps=0.05,
        seed=arguments.seed,
        device="cpu",
    )
    curve, begin = Curve(env), time.process_time()
    model.learn(arguments.steps, callback=curve)
    print(f"{model.num_timesteps:,} goals in {curve.progress.minutes():.1f} min, {(time.process_time() - begin) / 60.0:.1f} CPU min")
    env.close()
    model.save("explorer")
    model = DQN.load("explorer", device="cpu")
    report(lambda observation: model.predict(observation, deterministic=True)[0], curve.episodes, arguments)


if __name__ == "__main__":
    main()
