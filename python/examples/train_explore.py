"""A robot learns where to go in houses that change: NumPy alone, by the choice of goals (`curious/ExploreGoals-v0`).

At every step eight strategies propose a goal each. A small network predicts from what each goal promises the reward R that its
choice will earn, and the time T that it will take; the robot takes the goal with the largest R - rho T, where rho is the mean
reward per second so far (the average-reward criterion: Schwartz, 1993; Mahadevan, 1996). It learns from its own steps in
houses of `TRAIN_HOUSES`, and is measured in `TEST_HOUSES`, where every policy begins at the same place of the same house.

    python train_explore.py --minutes 10 --houses 200 --picture curve.png
"""

import argparse
import copy
import json
import time
from concurrent.futures import ThreadPoolExecutor
from types import MappingProxyType
from typing import Any, Callable, Sequence

import numpy as np
from curious.envs import TEST_HOUSES, ExploreEnv, ExploreGoalsEnv, ExploreGoalsVectorEnv

ENVS, HIDDEN, BATCH, RATE = 8, 32, 256, 2e-3
#: Strategies that draw their goals are there twice: what a goal promises says which one is better.
STRATEGIES = ["frontier", *2 * ["recency"], *2 * ["poisson"], *2 * ["predicted-change"], "random"]
#: The scales of reward and time (s) in the output of the network.
SCALES = np.array([10.0, 20.0], np.float32)
Choose = Callable[[dict[str, np.ndarray]], np.ndarray]
#: Rewards in place of those of the task: from the observations before, the choices, the observations after, and whether an
#: episode ended.
Pay = Callable[[dict[str, np.ndarray], np.ndarray, dict[str, np.ndarray], np.ndarray], np.ndarray]


def inputs(observation: dict[str, np.ndarray]) -> np.ndarray:
    """One row per candidate: its features, which strategy it is of, and the state of the map; shape (envs, strategies, n)."""
    candidates, state = observation["candidates"], observation["state"]
    envs, strategies, _ = candidates.shape
    names = np.broadcast_to(np.eye(strategies, dtype=np.float32), (envs, strategies, strategies))
    # Time left, known share, expected changes, longest unseen, last reward: not the place, which is of one house.
    state = np.broadcast_to(state[:, None, 4:], (envs, strategies, state.shape[1] - 4))
    return np.concatenate([candidates, names, state], axis=2)


class Net:
    """Predicts reward and time: one hidden layer, trained by Adam on the squared error."""

    def __init__(self, size: int, random: np.random.Generator) -> None:
        self.parts = [
            (random.normal(size=(size, HIDDEN)) / np.sqrt(size)).astype(np.float32),
            np.zeros(HIDDEN, np.float32),
            np.zeros((HIDDEN, 2), np.float32),
            np.zeros(2, np.float32),
        ]
        self.means, self.squares = ([np.zeros_like(part) for part in self.parts] for _ in range(2))
        self.steps = 0

    def predict(self, x: np.ndarray) -> np.ndarray:
        weights, biases, out, bias = self.parts
        return np.tanh(x @ weights + biases) @ out + bias

    def learn(self, x: np.ndarray, target: np.ndarray) -> None:
        weights, biases, out, bias = self.parts
        hidden = np.tanh(x @ weights + biases)
        error = 2.0 * (hidden @ out + bias - target) / len(x)
        inner = (error @ out.T) * (1.0 - hidden**2)
        self.steps += 1
        for part, mean, square, gradient in zip(
            self.parts, self.means, self.squares, [x.T @ inner, inner.sum(0), hidden.T @ error, error.sum(0)]
        ):
            mean += 0.1 * (gradient - mean)
            square += 0.001 * (gradient**2 - square)
            part -= RATE * (mean / (1 - 0.9**self.steps)) / (np.sqrt(square / (1 - 0.999**self.steps)) + 1e-8)


class Greedy:
    """Takes the goal with the largest R - rho T that a network predicts."""

    def __init__(self, net: Net, rate: float) -> None:
        self.net, self.rate = net, rate

    def __call__(self, observation: dict[str, np.ndarray]) -> np.ndarray:
        predicted = self.net.predict(inputs(observation)) * SCALES
        return (predicted[..., 0] - self.rate * predicted[..., 1]).argmax(axis=1)


class Progress:
    """Prints a line every ten seconds: the mean reward of the task per 300 s, over the last goals."""

    def __init__(self) -> None:
        self.begin = self.shown = time.perf_counter()
        self.last: list[tuple[float, float]] = []
        print("minutes   goals chosen   episodes   reward per 300 s, last 200 goals (more is better)", flush=True)

    def minutes(self) -> float:
        return (time.perf_counter() - self.begin) / 60.0

    def note(self, rewards: np.ndarray, times: np.ndarray, goals: int, episodes: int) -> None:
        self.last = [*self.last, *zip(rewards, times)][-200:]
        if time.perf_counter() - self.shown > 10.0:
            self.shown = time.perf_counter()
            reward, spent_s = np.sum(self.last, axis=0)
            print(f"{self.minutes():7.1f} {goals:>14,} {episodes:>10} {300.0 * reward / spent_s:>18.1f}", flush=True)


def train(
    minutes: float, seed: int, pay: Pay | None = None, goals: Sequence[int] = ()
) -> tuple[list[Greedy], list[tuple[float, float]]]:
    """Learns for some minutes, or, with `goals`, until this number of goals was chosen: the same policy on every machine.

    Returns the policies after each number of `goals` (or at the end), and (minutes, reward of the task) of every episode.
    """
    env = ExploreGoalsVectorEnv(num_envs=ENVS, strategies=STRATEGIES)
    random = np.random.default_rng(seed)
    observation, _ = env.reset(seed=seed)
    x = inputs(observation)
    net = Net(x.shape[2], random)
    seen: list[np.ndarray] = []
    targets: list[np.ndarray] = []
    returns, times = np.zeros(ENVS), np.zeros(ENVS)
    earned, spent_s = 0.0, 1e-9
    curve: list[tuple[float, float]] = []
    policies: list[Greedy] = []
    progress = Progress()
    while (done := len(seen) / goals[-1] if goals else progress.minutes() / minutes) < 1.0:
        choice = Greedy(net, earned / spent_s)(observation)
        # Tries something else: always at first, in one of twenty steps at last.
        tries = random.random(ENVS) < max(0.05, 1.0 - 2.5 * done)
        choice = np.where(tries, random.integers(0, x.shape[1], ENVS), choice)
        before = observation
        observation, earned_now, _, truncated, info = env.step(choice)
        rewards = earned_now if pay is None else pay(before, choice, ends_of(observation, info), truncated)
        # The values of `info` are those before a reset.
        lasted = info["time"] - times
        seen += list(x[np.arange(ENVS), choice])
        targets += list(np.stack([rewards, lasted], axis=1).astype(np.float32) / SCALES)
        # The mean reward per second forgets the first, worse choices.
        earned, spent_s = 0.998 * earned + rewards.sum(), 0.998 * spent_s + lasted.sum()
        returns += earned_now
        curve += [(progress.minutes(), float(total)) for total in returns[truncated]]
        returns, times = np.where(truncated, 0.0, returns), np.where(truncated, 0.0, info["time"])
        x = inputs(observation)
        if len(seen) >= BATCH:
            all_seen, all_targets = np.stack(seen[-20_000:]), np.stack(targets[-20_000:])
            for _ in range(8):
                batch = random.integers(0, len(all_seen), BATCH)
                net.learn(all_seen[batch], all_targets[batch])
        if len(policies) < len(goals) and len(seen) >= goals[len(policies)]:
            policies.append(Greedy(copy.deepcopy(net), earned / spent_s))
        progress.note(earned_now, lasted, len(seen), len(curve))
    env.close()
    return policies or [Greedy(net, earned / spent_s)], curve


def ends_of(observation: dict[str, np.ndarray], info: dict[str, Any]) -> dict[str, np.ndarray]:
    """The observations at the end of the step: of an episode that ended, the last one in place of the first of the next."""
    if "final_obs" not in info:
        return observation
    found = {key: part.copy() for key, part in observation.items()}
    for index, last in enumerate(info["final_obs"]):
        if last is not None:
            for key, part in found.items():
                part[index] = last[key]
    return found


def stand(observation: Any, step: int, random: np.random.Generator) -> list[float]:
    return [0.0, 0.0]


def drive_at_random(observation: Any, step: int, random: np.random.Generator) -> Any:
    return random.uniform(-1.0, 1.0, 2)


def wander(observation: Any, step: int, random: np.random.Generator) -> list[float]:
    """Ahead while nothing is near; else a turn, which changes its side every four seconds."""
    scan = observation["scan"]
    middle, side = len(scan) // 2, len(scan) // 10
    if scan[middle - side : middle + side].min() < NEAR:
        return [0.0, 1.0 if (step // 40) % 2 else -1.0]
    return [1.0, 0.3 * float(np.sin(0.02 * step))]


#: The policies that steer, and those that choose goals, with their strategies.
DRIVERS = {"standing still": stand, "driving at random": drive_at_random, "wandering": wander}
#: 0.6 m, as a share of the range of the laser of a house.
NEAR = 0.6 / 10.0
FIELDS = ("reward", "found_changes", "seen_m2", "collisions")


def episode(env: Any, act: Callable[[Any, int], Any], seed: int) -> list[float]:
    """One episode in the house, at the place and with the doors and people of a seed."""
    observation, _ = env.reset(options={"world_seed": seed})
    reward, step, truncated, info = 0.0, 0, False, {}
    while not truncated:
        observation, earned, _, truncated, info = env.step(act(observation, step))
        reward, step = reward + earned, step + 1
    return [reward, *(info[name] for name in FIELDS[1:])]


def measure(name: str, policy: Choose | None, houses: int, threads: int, settings: Any = MappingProxyType({})) -> np.ndarray:
    """One episode per seed, from 1 on, in houses of `TEST_HOUSES`; `settings` are those of the learned policy's goals."""
    used = {"strategies": STRATEGIES, **settings} if policy is not None or name == "any goal" else {"strategies": [name]}

    def some(first: int) -> list[list[float]]:
        env: Any = ExploreEnv(houses=TEST_HOUSES) if name in DRIVERS else ExploreGoalsEnv(houses=TEST_HOUSES, **used)
        return [one(env, seed) for seed in range(first, houses + 1, threads)]

    def one(env: Any, seed: int) -> list[float]:
        random = np.random.default_rng(seed)
        if name in DRIVERS:
            return episode(env, lambda seen, step: DRIVERS[name](seen, step, random), seed)
        if policy is not None:
            return episode(env, lambda seen, _: policy({key: part[None] for key, part in seen.items()})[0], seed)
        return episode(env, lambda *_: random.integers(0, len(used["strategies"])), seed)

    with ThreadPoolExecutor(threads) as pool:
        parts = list(pool.map(some, range(1, threads + 1)))
    return np.array([parts[index % threads][index // threads] for index in range(houses)])


def p_value(differences: np.ndarray) -> float:
    """Two-sided p of a paired test that changes signs at random (Fisher, 1935), 100,000 times."""
    random, more, draws = np.random.default_rng(0), 0, 100_000
    for _ in range(draws // 1000):
        signs = random.choice([-1.0, 1.0], (1000, len(differences)))
        more += int((np.abs(signs @ differences) >= abs(differences.sum()) - 1e-9).sum())
    return (more + 1) / (draws + 1)


def draw(curve: list[tuple[float, float]], means: dict[str, float], path: str) -> None:
    """The learning curve, and the means of the others as lines."""
    try:
        import matplotlib
    except ImportError:
        print("no picture: it needs `pip install matplotlib`")
        return
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(7, 4), layout="constrained")
    minutes, rewards = np.array(curve).T
    width = min(40, len(rewards))
    smooth = np.convolve(rewards, np.ones(width) / width, "valid")
    axes.plot(minutes, rewards, ".", color="0.8", label="one episode in a training house")
    axes.plot(minutes[width - 1 :], smooth, color="C0", label=f"mean of {width} episodes")
    for number, (name, mean) in enumerate(means.items()):
        axes.axhline(mean, color=f"C{number + 1}", linestyle="--", linewidth=1, label=f"{name}, test houses")
    axes.set(xlabel="minutes of training", ylabel="reward of an episode of 300 s", ylim=(0, None))
    axes.legend(fontsize=7, ncols=2)
    figure.savefig(path, dpi=120)


def add_arguments(parser: argparse.ArgumentParser, houses: int) -> None:
    """The arguments of `report`."""
    parser.add_argument("--houses", type=int, default=houses, help="test houses: %(default)s")
    parser.add_argument("--threads", type=int, default=2, help="for the test houses")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--others", default=",".join(OTHERS), help="policies to compare with, separated by commas: %(default)s")
    parser.add_argument("--picture", help="a PNG file for the learning curve")
    parser.add_argument("--json", help="a file for all numbers")


def report(
    policy: Choose | None, curve: list[tuple[float, float]], arguments: argparse.Namespace, settings: Any = MappingProxyType({})
) -> None:
    """Measures the learned policy, if there is one, and the others in the test houses; `settings`: see `measure`."""
    results: dict[str, np.ndarray] = {}
    if policy is not None:
        results["learned"] = measure("learned", policy, arguments.houses, arguments.threads, settings)
    print(f"\n{arguments.houses} test houses   reward ± s.e.   found    seen m²    contacts   p against learned")
    for name in [*results, *filter(None, arguments.others.split(","))]:
        if name not in results:
            results[name] = measure(name, None, arguments.houses, arguments.threads, settings)
        mean, error = results[name].mean(axis=0), results[name].std(axis=0, ddof=1) / np.sqrt(arguments.houses)
        p = ""
        if "learned" in results and name != "learned":
            p = f"{p_value(results['learned'][:, 0] - results[name][:, 0]):.5f}"
        print(f"{name:<20} {mean[0]:6.1f} ± {error[0]:4.1f} {mean[1]:10.0f} {mean[2]:8.1f} {mean[3]:8.2f}       {p}", flush=True)
        if arguments.json:
            with open(arguments.json, "w") as file:
                json.dump({"curve": curve, **{name: values.tolist() for name, values in results.items()}}, file)
    if arguments.picture and curve:
        draw(curve, {name: float(values[:, 0].mean()) for name, values in results.items()}, arguments.picture)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=10.0)
    add_arguments(parser, houses=200)
    arguments = parser.parse_args()
    if arguments.minutes > 0.0:
        (policy,), curve = train(arguments.minutes, arguments.seed)
        report(policy, curve, arguments)
    else:
        report(None, [], arguments)


OTHERS = [*DRIVERS, "any goal", "random", "frontier", "curious", "recency", "poisson", "predicted-change", "optimal-revisiting"]

if __name__ == "__main__":
    main()
