"""Where does a place change? `python map_a_bag.py LOG` reads a bag of ROS 2 (MCAP, SQLite) or a CARMEN log."""

import argparse

import curious
import numpy as np

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("log", metavar="LOG", help="a folder of rosbag2, or a file: .mcap, .db3, a CARMEN log")
log = curious.Log(parser.parse_args().log)
print(f"{len(log)} scans in {log.duration:.0f} s", *log.notes, sep="\n")
survey = curious.map_log(log)
rates = survey.mapper.rates()
# Rates are above 0 almost everywhere: a cell may have changed unseen.
statistics = survey.mapper.statistics()
changed = np.count_nonzero(statistics["block_events"] + statistics["free_events"])
print(f"{np.count_nonzero(survey.permanent == 1)} cells are permanent walls, {changed} cells changed")
for place in survey.places[:10]:
    at = f"{place['kind']} at ({place['x_m']:6.2f}, {place['y_m']:6.2f}) m"
    if place.get("passages_per_hour") is None:  # the times of the log are unusable
        print(f"{at}: {place['changes']} changes")
        continue
    low, high = ("?" if bound is None else f"{bound:.0f}" for bound in place["passages_per_hour_90"])
    print(f"{at}: {place['passages']} times in {place['observed_s']:.0f} s of looking: {low} to {high} times per hour")
with curious.Output("map.npz") as file:
    np.savez(file, states=survey.mapper.states(), rates=rates, permanent=survey.permanent, path=survey.trajectory)
