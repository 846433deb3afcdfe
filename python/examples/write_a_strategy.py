"""A strategy of your own in the trials: go where a change is likely, and near. Is it better than `curious`, and how sure is that?"""

import argparse
from itertools import product

import curious
import numpy as np


class NearChanges:
    """Weighs cells by the probability that they changed, per second of travel."""

    needs_travel = True

    def weigh(self, situation: curious.Situation) -> np.ndarray:
        """One weight per cell, shape (rows, columns); a goal is drawn in proportion to the mean weight of its patch."""
        return situation.mapper.change_probability() / (5.0 + situation.travel)


def p_value(differences: np.ndarray) -> float:
    """Two-sided p of a paired test: the share of all choices of signs with as large a sum (Fisher, 1935)."""
    sums = np.array(list(product([-1.0, 1.0], repeat=len(differences)))) @ differences
    return float(np.mean(np.abs(sums) >= abs(differences.sum()) - 1e-12))


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--seeds", type=int, default=6, choices=range(2, 17), metavar="2..16", help="fewer than 6 cannot show p < 0.05")
parser.add_argument("--seconds", type=int, default=1200, help="simulated seconds of a trial")
args = parser.parse_args()
errors: dict[str, list[float]] = {}
for seed in range(args.seeds):
    # The same seed is the same world for every strategy: the trials are paired.
    for strategy in (NearChanges(), "curious", "poisson", "random"):
        result = curious.trial("house", strategy, seed=seed, seconds=args.seconds)
        name = strategy if isinstance(strategy, str) else type(strategy).__name__
        errors.setdefault(name, []).append(result["log_error"])
        print(f"seed {seed}  {name:<12} log error {result['log_error']:.2f}  coverage {result['coverage']:.0%}", flush=True)
print(f"\nlog error (less is better) minus that of curious, {args.seeds} seeds, ± standard error, p of a paired test")
for name, values in errors.items():
    if name != "curious":
        differences = np.array(values) - np.array(errors["curious"])
        error = differences.std(ddof=1) / np.sqrt(len(differences))
        print(f"{name:<12} {differences.mean():+.3f} ± {error:.3f}  p {p_value(differences):.3f}")
