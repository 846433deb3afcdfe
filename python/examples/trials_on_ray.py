"""Trials on a cluster: every trial is a task of Ray, which repeats it elsewhere if a node is lost. `pip install ray`."""

import statistics

import curious
import ray

STRATEGIES = ["curious", "recency", "information-gain"]
SEEDS = range(8)

ray.init()
trial = ray.remote(curious.trial)
tasks = {
    (strategy, seed): trial.remote(curious.Spec.house(seed), strategy, seed=seed, seconds=600)
    for strategy in STRATEGIES
    for seed in SEEDS
}
results = dict(zip(tasks, ray.get(list(tasks.values()))))
for strategy in STRATEGIES:
    errors = [results[strategy, seed]["log_error"] for seed in SEEDS]
    print(f"{strategy:<18} log error {statistics.mean(errors):.3f} ± {statistics.stdev(errors) / len(errors) ** 0.5:.3f}")
