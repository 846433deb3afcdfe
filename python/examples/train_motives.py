"""Intrinsic rewards in houses that change: the learner of `train_explore.py`, paid by counts, prediction error or progress.

The learner chooses one of eight proposed goals (`curious/ExploreGoals-v0`). It never sees the reward of the task, only one of
these, after each goal:

- visits: 1/sqrt(n), n: how often a goal ended in this square of about 1 m in this episode (count-based exploration);
- distillation: the squared error with which a network predicts a fixed random network (Burda et al., 2018) from the place and from
  what the goal promised; it begins anew with every episode;
- surprise: the squared error of a model that predicts, from what the goal promised, what the robot sees next (Pathak et al., 2017);
- progress: how much the error of that model has fallen for goals of the same strategy (Oudeyer et al., 2007).

References: the reward of the task, any of the goals at random (no reward), and strategies of this package alone. The measure is that of
`docs/strategies.md`: the log error of the learned rates of change, as its mean over the episode (area) and at its end.

    python train_motives.py --minutes 2 --houses 40 --json numbers.json
"""

import argparse
import json
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from curious.envs import TEST_HOUSES, ExploreGoalsEnv
from train_explore import ENVS, STRATEGIES, Choose, p_value, train

#: The squares of the episode counts, per axis, and the length of an episode in the test houses, in steps of 0.1 s.
SQUARES, MAX_STEPS = 12, 6000
SINGLE = ["curious", "information-gain", "fresh-map", "frontier", "recency", "poisson", "predicted-change", "random"]
FIELDS = ("area", "log error", "reward", "found", "seen m2", "collisions")
Observation = dict[str, np.ndarray]


def features(before: Observation, choice: np.ndarray, after: Observation) -> np.ndarray:
    """What the chosen goal promised and where the robot is now, in waves; shape (envs, 17)."""
    promised = before["candidates"][np.arange(len(choice)), choice]
    at = after["state"][:, :2, None] * np.pi * np.array([1.0, 2.0])
    return np.concatenate([promised, np.sin(at).reshape(len(at), -1), np.cos(at).reshape(len(at), -1)], axis=1)


class Visits:
    def __init__(self, random: np.random.Generator) -> None:
        self.counts = np.zeros((ENVS, SQUARES, SQUARES))

    def __call__(self, before: Observation, choice: np.ndarray, after: Observation, ended: np.ndarray) -> np.ndarray:
        squares = (after["state"][:, :2] * SQUARES).astype(int).clip(0, SQUARES - 1)
        place = (np.arange(ENVS), squares[:, 1], squares[:, 0])
        self.counts[place] += 1.0
        rewards = 1.0 / np.sqrt(self.counts[place])
        self.counts[ended] = 0.0
        return rewards


class Distillation:
    """One predictor per environment."""

    def __init__(self, random: np.random.Generator, inputs: int = 17, hidden: int = 32, outputs: int = 8) -> None:
        self.target = random.normal(size=(inputs, hidden)) / np.sqrt(inputs), random.normal(size=(hidden, outputs))
        first = random.normal(size=(inputs, hidden)) / np.sqrt(inputs)
        self.start = first, np.zeros((hidden, outputs))
        self.first, self.second = (np.repeat(part[None], ENVS, axis=0) for part in self.start)

    def __call__(self, before: Observation, choice: np.ndarray, after: Observation, ended: np.ndarray) -> np.ndarray:
        x = features(before, choice, after)
        wanted = np.tanh(x @ self.target[0]) @ self.target[1]
        hidden = np.tanh(np.einsum("ei,eih->eh", x, self.first))
        error = np.einsum("eh,eho->eo", hidden, self.second) - wanted
        rewards = (error**2).mean(axis=1)
        inner = np.einsum("eo,eho->eh", error, self.second) * (1.0 - hidden**2)
        self.second -= 0.02 * hidden[:, :, None] * error[:, None, :]
        self.first -= 0.02 * x[:, :, None] * inner[:, None, :]
        for part, start in zip((self.first, self.second), self.start):
            part[ended] = start
        return rewards


class Surprise:
    """A linear model, which all environments share, of what the state and the goals in view will be."""

    def __init__(self, random: np.random.Generator) -> None:
        self.weights = np.zeros((10, 14))

    def __call__(self, before: Observation, choice: np.ndarray, after: Observation, ended: np.ndarray) -> np.ndarray:
        promised = before["candidates"][np.arange(len(choice)), choice]
        x = np.concatenate([promised, np.ones((len(promised), 1))], axis=1)
        seen = np.concatenate([after["state"][:, 4:], after["candidates"].mean(axis=1)], axis=1)
        error = np.where(ended[:, None], 0.0, x @ self.weights - seen)
        self.weights -= 0.05 * x.T @ error / len(x)
        return (error**2).sum(axis=1)


class Progress(Surprise):
    """How much the mean error of the last twenty goals of the strategy is below that of the twenty before."""

    def __init__(self, random: np.random.Generator) -> None:
        super().__init__(random)
        self.errors: list[list[float]] = [[] for _ in STRATEGIES]

    def __call__(self, before: Observation, choice: np.ndarray, after: Observation, ended: np.ndarray) -> np.ndarray:
        rewards = super().__call__(before, choice, after, ended)
        for index, strategy in enumerate(choice):
            errors = self.errors[strategy]
            errors.append(float(rewards[index]))
            del errors[:-40]
            half = len(errors) // 2
            rewards[index] = max(0.0, float(np.mean(errors[:half]) - np.mean(errors[half:]))) if half else 0.0
        return rewards


class Scaled:
    """Rewards divided by their root mean square, as the network expects rewards of about 5."""

    def __init__(self, motive: Any) -> None:
        self.motive, self.square, self.count = motive, 1e-12, 0

    def __call__(self, *arguments: Any) -> np.ndarray:
        rewards = self.motive(*arguments)
        self.count += 1
        self.square += (float((rewards**2).mean()) - self.square) / min(self.count, 1000)
        scaled: np.ndarray = 5.0 * rewards / np.sqrt(self.square)
        return scaled


MOTIVES = {"visits": Visits, "distillation": Distillation, "surprise": Surprise, "progress": Progress}


def measure(strategies: list[str], choose: Choose, houses: int, threads: int) -> np.ndarray:
    """One episode per seed, from 1 on, in houses of `TEST_HOUSES`: shape (houses, FIELDS)."""

    def some(first: int) -> list[list[float]]:
        env: Any = ExploreGoalsEnv(houses=TEST_HOUSES, strategies=strategies, max_steps=MAX_STEPS)
        return [episode(env, seed) for seed in range(first, houses + 1, threads)]

    def episode(env: Any, seed: int) -> list[float]:
        observation, _ = env.reset(options={"world_seed": seed})
        reward, area, last_s, truncated, info = 0.0, 0.0, 0.0, False, {}
        while not truncated:
            one = {key: part[None] for key, part in observation.items()}
            observation, earned, _, truncated, info = env.step(int(choose(one)[0]))
            reward += earned
            area += info["log_error"] * (info["time"] - last_s)
            last_s = info["time"]
        return [area / last_s, info["log_error"], reward, info["found_changes"], info["seen_m2"], info["collisions"]]

    with ThreadPoolExecutor(threads) as pool:
        parts = list(pool.map(some, range(1, threads + 1)))
    return np.array([parts[index % threads][index // threads] for index in range(houses)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=2.0, help="of training, per reward")
    parser.add_argument("--houses", type=int, default=40, help="test houses")
    parser.add_argument("--threads", type=int, default=2, help="for the test houses")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", help="a file for all numbers")
    arguments = parser.parse_args()
    results: dict[str, np.ndarray] = {}
    random = np.random.default_rng(3)
    print(f"{arguments.houses} test houses{'':<12}{'  '.join(FIELDS)}   area / curious, p   reward p")
    policies: list[tuple[str, list[str], Any]] = [(name, [name], None) for name in SINGLE]
    policies.append(("any goal", STRATEGIES, lambda seen: random.integers(0, len(STRATEGIES), 1)))
    policies += [(f"learned: {name}", STRATEGIES, name) for name in ("task", *MOTIVES) if arguments.minutes > 0.0]
    for name, strategies, choose in policies:
        if choose is None:
            choose = lambda seen: np.zeros(1, int)  # noqa: E731
        elif isinstance(choose, str):
            motive = None if choose == "task" else Scaled(MOTIVES[choose](np.random.default_rng(arguments.seed)))
            choose, _ = train(arguments.minutes, arguments.seed, motive)
        results[name] = found = measure(strategies, choose, arguments.houses, arguments.threads)
        compared = results["curious"]
        ps = [p_value(found[:, column] - compared[:, column]) for column in (0, 2)]
        ratio = found[:, 0].mean() / compared[:, 0].mean()
        numbers = " ".join(f"{value:9.3f}" for value in found.mean(axis=0))
        print(f"{name:<24} {numbers}    {ratio:.3f}, {ps[0]:.4f}   {ps[1]:.4f}", flush=True)
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump({name: values.tolist() for name, values in results.items()}, file)


if __name__ == "__main__":
    main()
