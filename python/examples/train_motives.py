"""Intrinsic rewards in houses that change: the learner of `train_explore.py`, paid by counts, prediction error or progress.

The learner chooses one of eight proposed goals (`curious/ExploreGoals-v0`). It never sees the reward of the task, only one of
these, after each goal:

- visits: 1/sqrt(n), n: how often a goal ended in this square of about 1 m in this episode (count-based exploration);
- distillation: the squared error with which a network predicts a fixed random network (Burda et al., 2018) from the place and from
  what the goal promised; it begins anew with every episode;
- surprise: the squared error of a model that predicts, from what the goal promised, what the robot sees next (Pathak et al., 2017);
- progress: how much the error of that model has fallen for goals of the same strategy (Oudeyer et al., 2007).

References: the reward of the task, any of the goals at random (no reward), and strategies of this package alone. The measure is that of
`docs/strategies.md`: the log error of the learned rates of change, as its mean over the episode (area) and at its end: less is better.
A learner is measured after each number of `--goals`, the goals that it has chosen in houses of `TRAIN_HOUSES`; several independent
trainings share the test houses.

    python train_motives.py --goals 500,2000 --trainings 2 --houses 40 --json numbers.json
"""

import argparse
import json
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from curious.envs import TEST_HOUSES, ExploreGoalsEnv
from train_explore import ENVS, STRATEGIES, p_value, train

#: The squares of the episode counts, per axis, and the length of an episode in the test houses, in steps of 0.1 s.
SQUARES, MAX_STEPS = 12, 6000
#: The strategy alone with the least area in other runs.
BEST = "predicted-change"
SINGLE = ["curious", "information-gain", "fresh-map", "frontier", "recency", "poisson", BEST, "random", "any goal"]
FIELDS = ("area", "log error", "reward", "found", "seen m2", "contacts")
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
        error = x @ self.weights - seen
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


#: The reward of the task, and the intrinsic ones.
MOTIVES: dict[str, Any] = {"task": None, "visits": Visits, "distillation": Distillation, "surprise": Surprise, "progress": Progress}


def measure(strategies: list[str], choosers: list[Any], houses: int, threads: int) -> np.ndarray:
    """One episode per seed, from 1 on, in houses of `TEST_HOUSES`, with the choosers in turn: shape (houses, FIELDS)."""

    def some(first: int) -> list[list[float]]:
        env: Any = ExploreGoalsEnv(houses=TEST_HOUSES, strategies=strategies, max_steps=MAX_STEPS)
        return [episode(env, seed) for seed in range(first, houses + 1, threads)]

    def episode(env: Any, seed: int) -> list[float]:
        observation, _ = env.reset(options={"world_seed": seed})
        random, choose = np.random.default_rng(seed), choosers[seed % len(choosers)]
        reward, area, last_s, truncated, info = 0.0, 0.0, 0.0, False, {}
        while not truncated:
            one = {key: part[None] for key, part in observation.items()}
            choice = random.integers(len(strategies)) if choose is None else choose(one)[0]
            observation, earned, _, truncated, info = env.step(int(choice))
            reward += earned
            area += info["log_error"] * (info["time"] - last_s)
            last_s = info["time"]
        return [area / last_s, info["log_error"], reward, info["found_changes"], info["seen_m2"], info["collisions"]]

    with ThreadPoolExecutor(threads) as pool:
        parts = list(pool.map(some, range(1, threads + 1)))
    return np.array([parts[index % threads][index // threads] for index in range(houses)])


class Table:
    """The rows of all policies, beside `curious` and the strategy with the least area."""

    def __init__(self, houses: int, path: str | None) -> None:
        self.rows: dict[str, np.ndarray] = {}
        self.path = path
        print(f"{houses} test houses{'':<17}{'  '.join(FIELDS)}   reward p   area / curious, p   / {BEST}, p")

    def add(self, name: str, found: np.ndarray) -> None:
        self.rows[name] = found
        numbers = " ".join(f"{value:9.3f}" for value in found.mean(axis=0))
        compared = f"{p_value(found[:, 2] - self.rows['curious'][:, 2]):.4f}" if "curious" in self.rows else ""
        for other in ("curious", BEST):
            if other in self.rows:
                areas, others = found[:, 0], self.rows[other][:, 0]
                compared += f"   {areas.mean() / others.mean():.3f}, {p_value(areas - others):.4f}"
        print(f"{name:<29} {numbers}    {compared}", flush=True)
        if self.path:
            with open(self.path, "w") as file:
                json.dump({name: values.tolist() for name, values in self.rows.items()}, file)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--goals", default="500,2000", help="experience before a measurement, ascending: %(default)s")
    parser.add_argument("--trainings", type=int, default=2, help="independent trainings per reward")
    parser.add_argument("--houses", type=int, default=40, help="test houses")
    parser.add_argument("--strategies", default=",".join(SINGLE), help="strategies to measure alone: %(default)s")
    parser.add_argument("--rewards", default=",".join(MOTIVES), help="rewards to learn from: %(default)s")
    parser.add_argument("--threads", type=int, default=2, help="for the test houses")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", help="a file for all numbers, written anew after every row")
    arguments = parser.parse_args()
    marks = [int(goals) for goals in arguments.goals.split(",")]
    table = Table(arguments.houses, arguments.json)
    for name in filter(None, arguments.strategies.split(",")):
        strategies = STRATEGIES if name == "any goal" else [name]
        table.add(name, measure(strategies, [None], arguments.houses, arguments.threads))
    for name in filter(None, arguments.rewards.split(",")):
        trained = []
        for seed in range(arguments.seed, arguments.seed + arguments.trainings):
            motive = MOTIVES[name]
            pay = motive and Scaled(motive(np.random.default_rng(seed)))
            trained.append(train(0.0, seed, pay, marks)[0])
        for mark, policies in zip(marks, zip(*trained)):
            found = measure(STRATEGIES, list(policies), arguments.houses, arguments.threads)
            table.add(f"{name}, {mark:,} goals", found)


if __name__ == "__main__":
    main()
