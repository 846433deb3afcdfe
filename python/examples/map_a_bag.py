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
    low, high = place["cycles_per_hour_90"]
    print(
        f"({place['x']:6.2f}, {place['y']:6.2f}) m: {place['cycles_per_hour']:6.1f} cycles per hour "
        f"({low:.1f} to {'?' if high is None else f'{high:.1f}'}), blocked {place['share_blocked']:4.0%} of the time"
    )
np.savez("map.npz", states=survey.mapper.states(), rates=rates, permanent=survey.permanent, path=survey.trajectory)
