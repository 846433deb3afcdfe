"""PPO of Stable-Baselines3 learns to drive to goals: `pip install stable-baselines3`, then `python train_sb3.py`.

The policy is saved to `driver.zip`, loaded again, and evaluated with seeds that it has never seen.
"""

import argparse
from typing import Any

import curious
import numpy as np
from curious.envs import DriveVectorEnv
from curious.sb3 import SB3VecEnv
from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--steps", type=int, default=500_000)
parser.add_argument("--episodes", type=int, default=200)
args = parser.parse_args()

env = SB3VecEnv(DriveVectorEnv(num_envs=64))
model = PPO("MlpPolicy", env, n_steps=128, batch_size=1024, n_epochs=4, learning_rate=5e-4, ent_coef=0.003, seed=0, device="cpu", verbose=1)
with curious.Output("driver.zip") as file:  # before the training: an error is known at once
    model.learn(args.steps)
    model.save(file)
env.close()

model = PPO.load("driver", device="cpu")
env = SB3VecEnv(DriveVectorEnv(num_envs=64))
env.seed(1_000_000)
successes: list[bool] = []


def note(values: dict[str, Any], _: dict[str, Any]) -> None:
    """Called at every step of every world."""
    if values["done"]:
        successes.append(bool(values["info"]["is_success"]))


returns, lengths = evaluate_policy(model, env, args.episodes, callback=note, return_episode_rewards=True)
print(f"{len(returns)} episodes with other seeds: {np.mean(successes):.1%} of the goals reached, return {np.mean(returns):.2f}")
