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
print(f"{np.count_nonzero(survey.permanent == 1)} cells are permanent walls, {np.count_nonzero(rates)} cells change")
for place in survey.places[:10]:
    at = f"({place['x']:6.2f}, {place['y']:6.2f}) m"
    if place["cycles_per_hour"] is None:  # the times of the log are unusable
        print(f"{at}: {place['changes']} changes")
        continue
    low, high = ("?" if bound is None else f"{bound:.1f}" for bound in place["cycles_per_hour_90"])
    print(
        f"{at}: {place['cycles_per_hour']:6.1f} cycles per hour ({low} to {high}), "
        f"blocked {place['share_blocked']:4.0%} of the time"
    )
np.savez("map.npz", states=survey.mapper.states(), rates=rates, permanent=survey.permanent, path=survey.trajectory)
