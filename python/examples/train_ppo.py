"""A robot learns to drive to goals through doorways: PPO (Schulman et al., 2017) in NumPy alone.

`python train_ppo.py --minutes 5` trains in all worlds of a vector environment, then drives 500 episodes with seeds that it
has never seen, and prints the share of goals that it reached, the contacts and the time, beside those of a rule of three
lines. `--minutes 0` measures the rule alone.
"""

import argparse
import time
from typing import Any, Callable

import numpy as np
from curious.envs import DriveVectorEnv

ENVS, STEPS, EPOCHS, BATCH = 64, 128, 4, 1024
GAMMA, LAMBDA, CLIP, RATE, ENTROPY = 0.99, 0.95, 0.2, 5e-4, 0.003


class Net:
    """A network with two hidden layers of 64 tanh units."""

    def __init__(self, sizes: list[int], scale: float, random: np.random.Generator) -> None:
        gains = [1.0] * (len(sizes) - 2) + [scale]
        pairs = list(zip(sizes, sizes[1:], gains))
        self.weights = [(random.normal(size=(a, b)) * gain / np.sqrt(a)).astype(np.float32) for a, b, gain in pairs]
        self.biases = [np.zeros(b, np.float32) for b in sizes[1:]]

    def forward(self, x: np.ndarray) -> list[np.ndarray]:
        """The values of all layers."""
        layers = [x]
        for index, (weight, bias) in enumerate(zip(self.weights, self.biases)):
            x = x @ weight + bias
            layers.append(x if index == len(self.weights) - 1 else np.tanh(x))
        return layers

    def backward(self, layers: list[np.ndarray], gradient: np.ndarray) -> list[np.ndarray]:
        """The gradients of weights and biases, from that of the output."""
        gradients: list[np.ndarray] = []
        for index in reversed(range(len(self.weights))):
            if index < len(self.weights) - 1:
                gradient = gradient * (1.0 - layers[index + 1] ** 2)
            gradients += [gradient.sum(axis=0), layers[index].T @ gradient]
            gradient = gradient @ self.weights[index].T
        return gradients[::-1]

    def parameters(self) -> list[np.ndarray]:
        return [part for pair in zip(self.weights, self.biases) for part in pair]


class Adam:
    """Adam (Kingma and Ba, 2015), with a limit on the norm of the gradient."""

    def __init__(self, parameters: list[np.ndarray]) -> None:
        self.parameters, self.steps = parameters, 0
        self.means = [np.zeros_like(part) for part in parameters]
        self.squares = [np.zeros_like(part) for part in parameters]

    def step(self, gradients: list[np.ndarray], rate: float) -> None:
        self.steps += 1
        norm = np.sqrt(sum(float((part**2).sum()) for part in gradients))
        shrink = min(1.0, 0.5 / (norm + 1e-8))
        for part, gradient, mean, square in zip(self.parameters, gradients, self.means, self.squares):
            gradient = gradient * shrink
            mean += 0.1 * (gradient - mean)
            square += 0.001 * (gradient**2 - square)
            part -= rate * (mean / (1 - 0.9**self.steps)) / (np.sqrt(square / (1 - 0.999**self.steps)) + 1e-8)


class Policy:
    """Gaussian actions around the output of a network."""

    def __init__(self, observations: int, random: np.random.Generator) -> None:
        self.actor = Net([observations, 64, 64, 2], 0.01, random)
        self.critic = Net([observations, 64, 64, 1], 1.0, random)
        self.log_std = np.full(2, -0.5, np.float32)

    def best(self, observations: np.ndarray) -> np.ndarray:
        """The actions without noise."""
        actions: np.ndarray = np.clip(self.actor.forward(observations)[-1], -1.0, 1.0)
        return actions

    def log_probability(self, actions: np.ndarray, mean: np.ndarray) -> np.ndarray:
        z = (actions - mean) / np.exp(self.log_std)
        log_probability: np.ndarray = -0.5 * (z**2).sum(axis=1) - self.log_std.sum() - np.log(2.0 * np.pi)
        return log_probability


def train(env: Any, minutes: float, seed: int) -> tuple[Policy, list[tuple[float, int, float, float]]]:
    """Learns for some minutes. Returns the policy, and (minutes, steps, share of goals, contacts) every ten seconds."""
    random = np.random.default_rng(seed)
    observation, _ = env.reset(seed=seed)
    policy = Policy(observation.shape[1], random)
    parameters = [*policy.actor.parameters(), *policy.critic.parameters(), policy.log_std]
    adam = Adam(parameters)
    begin, steps, shown = time.perf_counter(), 0, 0.0
    recent: list[float] = []
    contacts: list[float] = []
    print("minutes        steps    goals   contacts (last 500 episodes: more goals, fewer contacts are better)   noise σ")
    curve: list[tuple[float, int, float, float]] = []
    while (spent := (time.perf_counter() - begin) / 60.0) < minutes:
        observations = np.empty((STEPS, ENVS, observation.shape[1]), np.float32)
        actions, log_probabilities = np.empty((STEPS, ENVS, 2), np.float32), np.empty((STEPS, ENVS), np.float32)
        rewards, values, goes_on = (np.empty((STEPS, ENVS), np.float32) for _ in range(3))
        for step in range(STEPS):
            mean = policy.actor.forward(observation)[-1]
            action = mean + np.exp(policy.log_std) * random.standard_normal(mean.shape).astype(np.float32)
            observations[step], actions[step] = observation, action
            log_probabilities[step] = policy.log_probability(action, mean)
            values[step] = policy.critic.forward(observation)[-1][:, 0]
            observation, reward, terminated, truncated, info = env.step(np.clip(action, -1.0, 1.0))
            rewards[step] = reward
            if truncated.any():
                # An episode that was only too long is worth what its last observation promises.
                last = np.stack([info["final_obs"][index] for index in np.flatnonzero(truncated)])
                rewards[step, truncated] += GAMMA * policy.critic.forward(last)[-1][:, 0]
            goes_on[step] = ~(terminated | truncated)
            if "final_info" in info:
                recent += info["final_info"]["is_success"][info["_final_info"]].tolist()
                contacts += info["final_info"]["collisions"][info["_final_info"]].tolist()
        advantages, advantage = np.empty_like(rewards), np.zeros(ENVS, np.float32)
        following = policy.critic.forward(observation)[-1][:, 0]
        for step in reversed(range(STEPS)):
            error = rewards[step] + GAMMA * goes_on[step] * following - values[step]
            advantages[step] = advantage = error + GAMMA * LAMBDA * goes_on[step] * advantage
            following = values[step]
        flat = [part.reshape(STEPS * ENVS, *part.shape[2:]) for part in (observations, actions, log_probabilities)]
        returns, gains = (advantages + values).ravel(), advantages.ravel()
        rate = RATE * max(0.05, 1.0 - spent / minutes)
        for _ in range(EPOCHS):
            for batch in random.permutation(STEPS * ENVS).reshape(-1, BATCH):
                update(policy, adam, rate, *(part[batch] for part in (*flat, returns, gains)))
        steps += STEPS * ENVS
        if time.perf_counter() - shown > 10.0 and recent:
            shown, recent, contacts = time.perf_counter(), recent[-500:], contacts[-500:]
            share, hits = float(np.mean(recent)), float(np.mean(contacts))
            if len(recent) >= 100:
                curve.append((spent, steps, share, hits))
            print(f"{spent:7.1f} {steps:>12,} {share:>8.0%} {hits:>10.2f}   {np.exp(policy.log_std).round(2)}", flush=True)
    env.close()
    return policy, curve


def update(
    policy: Policy,
    adam: Adam,
    rate: float,
    observations: np.ndarray,
    actions: np.ndarray,
    old: np.ndarray,
    returns: np.ndarray,
    advantages: np.ndarray,
) -> None:
    """One step of gradient descent on the clipped objective."""
    count = len(observations)
    advantages = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
    layers = policy.actor.forward(observations)
    std = np.exp(policy.log_std)
    z = (actions - layers[-1]) / std
    ratio = np.exp(policy.log_probability(actions, layers[-1]) - old)
    is_limited = np.where(advantages > 0.0, ratio > 1.0 + CLIP, ratio < 1.0 - CLIP)
    weight = np.where(is_limited, 0.0, -advantages * ratio)[:, None] / count
    gradients = policy.actor.backward(layers, (weight * z / std).astype(np.float32))
    of_log_std = (weight * (z**2 - 1.0)).sum(axis=0) - ENTROPY
    layers = policy.critic.forward(observations)
    error = (layers[-1][:, 0] - returns)[:, None] / count
    gradients += policy.critic.backward(layers, error.astype(np.float32))
    adam.step([*gradients, of_log_std.astype(np.float32)], rate)


def rule(rows: np.ndarray) -> np.ndarray:
    """Follows the shortest path, and slows down where the scan is near ahead."""
    return toward(rows, 67)


def toward(rows: np.ndarray, column: int) -> np.ndarray:
    """Follows the direction at a column of the observation."""
    cos, sin, near = rows[:, column], rows[:, column + 1], rows[:, 28:37].min(axis=1)
    speed = np.where(cos < 0.5, 0.0, np.clip(4.0 * near - 0.2, 0.1, 1.0) * cos)
    return np.stack([speed, 1.2 * np.arctan2(sin, cos)], axis=1).clip(-1.0, 1.0)


def evaluate(name: str, policy: Callable[[np.ndarray], np.ndarray], episodes: int, first_seed: int) -> None:
    """Drives episodes with other seeds, one per world."""
    env = DriveVectorEnv(num_envs=episodes)
    observation, _ = env.reset(seed=[first_seed + episode for episode in range(episodes)])
    success, is_over, contacts = np.zeros(episodes, bool), np.zeros(episodes, bool), np.zeros(episodes)
    steps = np.zeros(episodes)
    while not is_over.all():
        observation, _, terminated, truncated, info = env.step(policy(observation))
        ended = (terminated | truncated) & ~is_over
        success |= ended & terminated
        steps += ~is_over
        if "final_info" in info:
            contacts[ended] = info["final_info"]["collisions"][ended]
        is_over |= ended
    print(f"{name}, {episodes} episodes with other seeds: {success.mean():.1%} of all goals reached")
    print(f"  contacts per episode {contacts.mean():.2f}, without any {(contacts == 0).mean():.1%}")
    print(f"  time to the goal {0.1 * steps[success].mean():.1f} s")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=5.0)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    evaluate("rule", rule, episodes=500, first_seed=1_000_000)
    if arguments.minutes > 0.0:
        learned, _ = train(DriveVectorEnv(num_envs=ENVS), arguments.minutes, arguments.seed)
        evaluate("PPO", learned.best, episodes=500, first_seed=1_000_000)
