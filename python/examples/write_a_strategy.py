"""A strategy of your own in the trials: go where a change is likely, and near."""

import argparse

import curious
import numpy as np


class NearChanges:
    """Weighs cells by the probability that they changed, per second of travel."""

    needs_travel = True

    def weigh(self, situation: curious.Situation) -> np.ndarray:
        """One weight per cell, shape (rows, columns); a goal is drawn in proportion to the mean weight of its patch."""
        return situation.mapper.change_probability() / (5.0 + situation.travel)


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--seeds", type=int, default=3)
parser.add_argument("--seconds", type=int, default=1200, help="simulated seconds of a trial")
args = parser.parse_args()
for seed in range(args.seeds):
    # The same seed is the same world for every strategy: the trials are paired.
    for strategy in (NearChanges(), "poisson", "recency", "random"):
        result = curious.trial("house", strategy, seed=seed, seconds=args.seconds)
        name = strategy if isinstance(strategy, str) else type(strategy).__name__
        print(f"seed {seed}  {name:<12} log error {result['log_error']:.2f}  coverage {result['coverage']:.0%}")
