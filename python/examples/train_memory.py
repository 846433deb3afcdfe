"""A robot learns to find its goals without a map or a path: PPO in NumPy alone, in many houses, with a memory of where it was.

The observation has the scan, and distance and direction of the goal as the crow flies (`shows_path=False`). A robot that follows
them stays in the first dead end. `shows_memory=True` adds what the robot remembers of the episode: where it was, and what it saw.
It learns in houses of `TRAIN_HOUSES`, and is measured in `TEST_HOUSES`, beside a robot that drives at random, the rule of
`train_ppo.py` toward the goal, and the same rule with the shortest path, which the others do not see.

    python train_memory.py --minutes 15 --picture curve.png --json numbers.json
"""

import argparse
import json
import re
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable

import curious
import numpy as np
from curious.envs import TEST_HOUSES, TRAIN_HOUSES, DriveVectorEnv
from train_ppo import ENVS, Policy, toward, train

#: The columns of an observation where the directions of the goal and of the shortest path begin.
GOAL, PATH = 65, 67
BEAMS, MAX_STEPS = 64, 600
#: While learning. With the default of -0.5 per contact, a robot that stands still more and more earns most.
REWARDS = {"goal_reward": 20.0, "collision_reward": -0.2}


def p_value(differences: np.ndarray) -> float:
    """Two-sided p of a paired test that changes signs at random (Fisher, 1935), 100,000 times."""
    random, more, draws = np.random.default_rng(0), 0, 100_000
    for _ in range(draws // 1000):
        signs = random.choice([-1.0, 1.0], (1000, len(differences)))
        more += int((np.abs(signs @ differences) >= abs(differences.sum()) - 1e-9).sum())
    return (more + 1) / (draws + 1)


def house(seed: int) -> curious.Spec:
    """A generated house, with the laser of the driving task: 64 beams, 5 m."""
    text = curious.Spec.house(seed).to_toml()
    text = text.replace("[physics]\n", '[physics]\ncontacts = "sliding"\n', 1)
    text = re.sub(r"beams = 720", f"beams = {BEAMS}", text, count=1)
    return curious.Spec.from_toml(text.replace("range_max_m = 10.0", "range_max_m = 5.0", 1))


class Houses:
    """The same task in some houses, as one vector environment."""

    def __init__(self, seeds: list[int], envs: int, threads: int = 2, **settings: Any) -> None:
        self.pool, self.envs = ThreadPoolExecutor(threads), envs
        make = lambda seed: DriveVectorEnv(envs, threads=1, world=house(seed), max_steps=MAX_STEPS, **settings)  # noqa: E731
        self.houses = list(self.pool.map(make, seeds))
        self.names = self.houses[0].batch.info_names

    def _all(self, call: Callable[[int], Any]) -> list[Any]:
        return list(self.pool.map(call, range(len(self.houses))))

    def reset(self, seed: int) -> tuple[np.ndarray, dict[str, Any]]:
        self.random = np.random.default_rng(seed)
        seeds = self._seeds()
        return np.concatenate(self._all(lambda index: self.houses[index].batch.reset(seeds[index]))), {}

    def _seeds(self) -> np.ndarray:
        return self.random.integers(0, 1 << 63, (len(self.houses), self.envs)).astype(np.uint64)

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """As a vector environment does, without what PPO does not need."""
        parts, seeds = actions.astype(np.float32).reshape(len(self.houses), self.envs, 2), self._seeds()
        results = self._all(lambda index: self.houses[index].batch.step(parts[index], seeds[index]))
        rows, rewards, terminated, truncated, values, was_reset = (
            np.concatenate([result[part] for result in results]) for part in range(6)
        )
        info: dict[str, Any] = {}
        if was_reset.any():
            final = np.empty(len(rows), object)
            for index in np.flatnonzero(was_reset):
                final[index] = results[index // self.envs][6].reshape(self.envs, -1)[index % self.envs]
            named = {name: values[:, column] for column, name in enumerate(self.names)}
            info = {"final_obs": final, "final_info": named, "_final_info": was_reset}
        return rows, rewards, terminated, truncated, info

    def close(self) -> None:
        self.pool.shutdown()


def evaluate(act: Callable[[np.ndarray], np.ndarray], houses: int, episodes: int, **settings: Any) -> np.ndarray:
    """The same episodes for every policy: goal reached, contacts and time (s); shape (houses, episodes, 3)."""
    env = Houses(list(TEST_HOUSES)[:houses], episodes, **settings)
    rows, _ = env.reset(seed=12345)
    found, is_over, steps = np.zeros((len(rows), 3)), np.zeros(len(rows), bool), 0
    while not is_over.all():
        rows, _, terminated, _, info = env.step(act(rows))
        steps += 1
        if info:
            ended = info["_final_info"] & ~is_over
            contacts = info["final_info"]["collisions"]
            found[ended] = np.stack([terminated, contacts, np.full(len(rows), 0.1 * steps)], axis=1)[ended]
            is_over |= ended
    env.close()
    return found.reshape(houses, episodes, 3)


def draw(curves: dict[str, list[tuple[float, int, float, float]]], lines: dict[str, float], path: str) -> None:
    """The share of goals and the contacts while learning, and the shares of the others in the test houses as lines."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (axes, below) = pyplot.subplots(
        2, 1, figsize=(7, 5.5), sharex=True, height_ratios=(2, 1), layout="constrained"
    )
    for name, curve in curves.items():
        minutes, _, shares, contacts = np.array(curve).T
        axes.plot(minutes, 100.0 * shares, label=f"{name}, training houses")
        below.plot(minutes, contacts)
    for number, (name, share) in enumerate(lines.items()):
        axes.axhline(100.0 * share, color=f"C{number + 2}", linestyle="--", linewidth=1, label=f"{name}, test houses")
    axes.set(ylabel="goals reached, % (500 episodes)", ylim=(0, 100))
    axes.legend(fontsize=7, ncols=2)
    below.set(xlabel="minutes of training", ylabel="contacts per episode", ylim=(0, None))
    with curious.Output(path) as file:
        figure.savefig(file, dpi=120)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=15.0, help="of training, per learned policy")
    parser.add_argument("--train-houses", type=int, default=64)
    parser.add_argument("--houses", type=int, default=50, help="test houses")
    parser.add_argument("--episodes", type=int, default=8, help="per test house")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--memory", choices=["yes", "no"], default="yes", help="whether the policy has a memory")
    parser.add_argument("--picture", help="a PNG file for the learning curve")
    parser.add_argument("--json", help="a file for all numbers")
    arguments = parser.parse_args()
    settings: dict[str, dict[str, Any]] = {
        "driving at random": {"shows_path": False},
        "rule toward the goal": {"shows_path": False},
        "rule with the path": {"shows_path": True},
    }
    learned = "PPO with memory" if arguments.memory == "yes" else "PPO without memory"
    settings[learned] = {"shows_path": False, "shows_memory": arguments.memory == "yes"}
    random = np.random.default_rng(1)
    policies: dict[str, Callable[[np.ndarray], np.ndarray]] = {
        "driving at random": lambda rows: random.uniform(-1.0, 1.0, (len(rows), 2)),
        "rule toward the goal": lambda rows: toward(rows, GOAL),
        "rule with the path": lambda rows: toward(rows, PATH),
    }
    curves: dict[str, list[tuple[float, int, float, float]]] = {}
    if arguments.minutes > 0.0:
        seeds = list(TRAIN_HOUSES)[: arguments.train_houses]
        env = Houses(seeds, ENVS // len(seeds), **settings[learned], **REWARDS)
        policy, curves[learned] = train(env, arguments.minutes, arguments.seed)
        policies[learned] = noisy(policy, np.random.default_rng(2))
    results: dict[str, np.ndarray] = {}
    print(f"{arguments.houses} test houses, {arguments.episodes} episodes each")
    for name, act in policies.items():
        results[name] = found = evaluate(act, arguments.houses, arguments.episodes, **settings[name])
        shares, contacts = found[..., 0].mean(axis=1), found[..., 1]
        error = shares.std(ddof=1) / np.sqrt(len(shares))
        p = ""
        if name == learned:
            differences = shares - results["rule toward the goal"][..., 0].mean(axis=1)
            p = f", p {p_value(differences):.5f} against the rule toward the goal"
        print(
            f"{name:<22} {shares.mean():6.1%} ± {error:.1%} of the goals, {contacts.mean():5.2f} contacts, "
            f"{(contacts == 0).mean():4.0%} without any{p}",
            flush=True,
        )
    if arguments.json:
        with curious.Output(arguments.json) as path, open(path, "w") as file:
            json.dump({"curves": curves, **{name: found.tolist() for name, found in results.items()}}, file)
    if arguments.picture and curves:
        draw(curves, {name: float(found[..., 0].mean()) for name, found in results.items()}, arguments.picture)


def noisy(policy: Policy, random: np.random.Generator) -> Callable[[np.ndarray], np.ndarray]:
    """The actions with the noise that was learned: it helps out of corners."""

    def act(rows: np.ndarray) -> np.ndarray:
        mean = policy.actor.forward(rows)[-1]
        noise = np.exp(policy.log_std) * random.standard_normal(mean.shape)
        return np.clip(mean + noise, -1.0, 1.0)

    return act


if __name__ == "__main__":
    main()
