"""Trials on a cluster: every trial is a task of Ray, which repeats it elsewhere if a node is lost. `pip install ray`."""

import argparse
import statistics
from typing import Any

import curious
import ray

STRATEGIES = ["curious", "recency", "information-gain"]


@ray.remote
def trial(world: curious.Spec, strategy: str, seed: int, seconds: int) -> dict[str, Any]:
    """A trial in another process: Ray takes functions of Python only."""
    return curious.trial(world, strategy, seed=seed, seconds=seconds)


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--seeds", type=int, default=8)
parser.add_argument("--seconds", type=int, default=600)
args = parser.parse_args()

ray.init()
seeds = range(args.seeds)
tasks = {
    (strategy, seed): trial.remote(curious.Spec.house(seed), strategy, seed, args.seconds)
    for strategy in STRATEGIES
    for seed in seeds
}
results = dict(zip(tasks, ray.get(list(tasks.values()))))
for strategy in STRATEGIES:
    errors = [results[strategy, seed]["log_error"] for seed in seeds]
    spread = statistics.stdev(errors) / len(errors) ** 0.5 if len(errors) > 1 else float("nan")
    print(f"{strategy:<18} log error {statistics.mean(errors):.3f} ± {spread:.3f}")
