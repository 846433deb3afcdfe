"""The mapper, the localizer, logs and trials."""

import pickle

import curious
import numpy as np
import pytest


def room(pose, beams=360, side=4.0):
    """The ranges in a square room with its lower left corner at the origin."""
    angles = pose[2] - np.pi + np.arange(beams) * 2.0 * np.pi / beams
    cos, sin = np.cos(angles), np.sin(angles)
    with np.errstate(divide="ignore"):
        x = np.where(cos > 0, (side - pose[0]) / cos, np.where(cos < 0, -pose[0] / cos, np.inf))
        y = np.where(sin > 0, (side - pose[1]) / sin, np.where(sin < 0, -pose[1] / sin, np.inf))
    return np.minimum(x, y)


def test_own_scans_make_a_map():
    mapper = curious.Mapper(5.0, 5.0, origin=(-0.5, -0.5))
    assert mapper.shape == (100, 100) and mapper.origin.tolist() == [-0.5, -0.5]
    pose = [2.0, 1.5, 0.7]
    for step in range(40):
        mapper.update(0.1 * step, room(pose), pose)
    states = mapper.states()
    assert states.dtype == np.int8 and states.shape == (100, 100)
    cell = lambda x, y: (int((y + 0.5) / 0.05), int((x + 0.5) / 0.05))
    assert states[cell(2.0, 2.0)] == 0 and states[cell(4.02, 2.0)] == 1 and states[cell(-0.4, -0.4)] == -1
    assert mapper.readings == 40 and mapper.time == pytest.approx(3.9)
    assert mapper.points().shape == (360, 2) and mapper.recency()[cell(2.0, 2.0)] == 0.0
    assert mapper.blocked_probability()[cell(-0.4, -0.4)] == 0.5
    low, high = mapper.credible_intervals(0.9)
    assert (low <= high).all() and (mapper.rates() == 0.0).all() and np.isinf(mapper.intervals()).all()
    # A list, another type and another order of memory are the same scan.
    other = curious.Mapper(5.0, 5.0, origin=(-0.5, -0.5))
    for step in range(40):
        ranges = room(pose)
        scan = [list(ranges), ranges.astype(np.float32), np.stack([ranges, ranges], 1)[:, 0]][step % 3]
        other.update(0.1 * step, scan, tuple(pose))
    np.testing.assert_array_equal(other.states(), states)


def test_a_thing_that_comes_and_goes_has_a_rate():
    mapper = curious.Mapper(4.2, 4.2, origin=(-0.1, -0.1))
    pose, free = [2.0, 2.0, 0.0], room([2.0, 2.0, 0.0])
    blocked = free.copy()
    blocked[170:190] = 1.0  # behind the first beam is angle -pi, so beam 180 looks along x
    changes = 0
    for step in range(2000):
        mapper.update(0.1 * step, blocked if step // 100 % 2 else free, pose)
        changes += len(mapper.changes())
    row, column = int(2.1 / 0.05), int(3.11 / 0.05)
    rates = mapper.rates()
    # A cycle takes 20 s.
    assert rates.max() == pytest.approx(0.05, rel=0.4)
    found = np.argwhere(rates > 0.02)
    assert np.abs(found - [row, column]).min(axis=0).max() <= 2 and changes > 20
    low, high = mapper.credible_intervals()
    cell = np.unravel_index(rates.argmax(), rates.shape)
    assert low[cell] < rates[cell] < high[cell]
    statistics = mapper.statistics()
    assert statistics["block_events"][cell] >= 8 and statistics["watched_free"][cell] > 50.0
    snapshot, expected = mapper.snapshot(), mapper.rates()
    mapper.update(201.0, free, pose)
    with pytest.raises(curious.SnapshotError):
        mapper.restore(snapshot[:-5])
    mapper.restore(snapshot)
    np.testing.assert_array_equal(mapper.rates(), expected)
    assert "paper" in curious.Mapper.estimators()


@pytest.mark.parametrize(
    ("arguments", "keywords", "message"),
    [
        ((np.nan, [1.0] * 8, [0.0, 0.0, 0.0]), {}, "time must not go backwards"),
        ((-5.0, [1.0] * 8, [0.0, 0.0, 0.0]), {}, "time must not go backwards"),
        ((5.0, [1.0] * 8, [0.0, np.nan, 0.0]), {}, "a pose is finite"),
        ((5.0, [1.0] * 8, [1e9, 0.0, 0.0]), {}, "not a place"),
        ((5.0, [1.0] * 8, [0.0, 0.0]), {}, "not 2 numbers"),
        ((5.0, [1.0] * 8, [0.0, 0.0, 0.0]), {"angle_increment": 3.0}, "at most one turn"),
        ((5.0, [1.0] * 8, [0.0, 0.0, 0.0]), {"range_max": -1.0}, "range limits"),
        ((5.0, [1.0] * 8, [0.0, 0.0, 0.0]), {"angle_min": np.inf}, "finite"),
        ((5.0, [1.0] * 8, [0.0, 0.0, 0.0]), {"mount": [0.0]}, "not 1 numbers"),
    ],
)
def test_invalid_scans_are_refused_and_change_nothing(arguments, keywords, message):
    mapper = curious.Mapper(4.0, 4.0)
    mapper.update(1.0, room([2.0, 2.0, 0.0]), [2.0, 2.0, 0.0])
    before = mapper.snapshot()
    with pytest.raises(ValueError, match=message):
        mapper.update(*arguments, **keywords)
    assert mapper.snapshot() == before
    # Values that are not ranges are no error.
    mapper.update(2.0, [np.nan, np.inf, -np.inf, -1.0, 0.0, 1e30], [2.0, 2.0, 0.0])


def test_invalid_settings():
    with pytest.raises(ValueError, match="1 to 2\\^30 cells"):
        curious.Mapper(1e9, 1.0)
    with pytest.raises(ValueError, match="no estimator is called `best`"):
        curious.Mapper(1.0, 1.0, estimator="best")
    with pytest.raises(ValueError, match="range_noise_std_m"):
        curious.Mapper(1.0, 1.0, range_noise=-1.0)
    with pytest.raises((TypeError, ValueError)):
        curious.Mapper(1.0, 1.0).update(0.0, "ranges", [0.0, 0.0, 0.0])


def test_a_session_begins_at_a_time():
    mapper = curious.Mapper(5.0, 4.0)
    mapper.update(1.0, [1.0, 1.0, 1.0], [2.0, 2.0, 0.0])
    for time in (np.inf, -np.inf, np.nan):
        with pytest.raises(ValueError, match="the time of a session is finite, and not"):
            mapper.pause(time)
    mapper.pause(100.0)
    mapper.update(100.0, [1.0, 1.0, 1.0], [2.0, 2.0, 0.0])
    assert mapper.time == 100.0


def test_a_world_is_mapped_and_scored():
    world = curious.World("four_rooms", seed=2, exact=True)
    mapper = world.mapper()
    for step in range(600):
        mapper.update_reading(world.sense())
        world.act(0.5, 0.8 if step % 40 < 12 else 0.0)
    scores = world.score(mapper)
    assert 0.1 < scores["coverage"] <= 1.0 and 0.0 < scores["map_quality"] <= 1.0
    assert scores["log_error"] is None or scores["log_error"] <= np.log(10.0)
    assert curious.Mapper.of("four_rooms", estimator="paper").shape == mapper.shape
    with pytest.raises(ValueError, match="other cells"):
        world.score(curious.Mapper(1.0, 1.0))


def test_a_localizer_finds_the_pose():
    world = curious.World("drifting_house", seed=1)
    mapper = world.mapper()
    localizer = curious.Localizer(mapper, world.true_pose)
    for step in range(150):
        estimate = localizer.localize(world.sense(), mapper)
        (mapper.update_reading if estimate.is_certain else mapper.skip)(estimate.reading)
        if step > 40:
            world.act(0.2, 0.3)
        else:
            world.act(0.0, 0.0)
    assert estimate.state in ("tracking", "uncertain") and estimate.covariance.shape == (3, 3)
    distance = np.hypot(*(localizer.localize(world.sense(), mapper).pose - world.true_pose)[:2])
    assert distance < 0.1


def carmen(path, scans=300):
    """A standing laser; a box stands before it now and then."""
    lines = ["# a log"]
    free = room([2.0, 2.0, 0.0], beams=360)
    half = free[90:271:1][:181]
    for step in range(scans):
        ranges = half.copy()
        if step // 50 % 2:
            ranges[70:111] = 1.0
        numbers = " ".join(f"{value:.3f}" for value in ranges)
        time = 1e9 + 0.1 * step
        lines.append(f"FLASER 181 {numbers} 0 0 0 0 0 0 {time:.3f} host {time:.3f}")
    path.write_text("\n".join(lines) + "\n")


def test_a_log_is_read(tmp_path):
    path = tmp_path / "a.log"
    carmen(path)
    log = curious.Log(path)
    assert len(log) == 300 and log.stands and log.duration == pytest.approx(29.9, abs=0.01)
    readings = list(log)
    assert len(readings) == 300 and readings[0].ranges.shape == (181,) and readings[0].time == 0.0
    with pytest.raises(ValueError, match="map_frame"):
        curious.Log(path, map_frame="map")
    # A laser that stands has the same pose in all FLASER lines.
    corrected = curious.Log(path, corrected=True)
    assert corrected.corrected and not log.corrected
    with pytest.raises(FileNotFoundError):
        curious.Log(tmp_path / "b.log")
    (tmp_path / "c.log").write_text("FLASER 3 1.0 x\n")
    with pytest.raises(ValueError, match="c.log"):
        curious.Log(tmp_path / "c.log")


class Oldest:
    """Goes where nobody was for long: `recency` in Python."""

    needs_travel = False

    def __init__(self):
        self.calls = 0

    def weigh(self, situation):
        self.calls += 1
        assert situation.pose.shape == (3,) and not hasattr(situation, "travel")
        return situation.mapper.recency()


def test_a_strategy_of_python_runs_in_a_trial():
    strategy = Oldest()
    result = curious.trial("four_rooms", strategy, seed=3, seconds=60)
    assert strategy.calls > 0
    # It is the strategy of the library.
    expected = curious.trial("four_rooms", "recency", seed=3, seconds=60)
    assert result["map_hash"] == expected["map_hash"] and result["log_error"] == expected["log_error"]
    assert result["strategy_share"] == {"python": 1.0} and result["samples"]["time"][-1] == 60
    assert "curious" in curious.strategies()


def test_errors_of_strategies_end_the_trial():
    class Wrong:
        needs_travel = True

        def weigh(self, situation):
            assert situation.travel.shape == situation.mapper.shape
            return np.zeros((2, 2))

    class Raises:
        def weigh(self, situation):
            raise KeyError("mine")

    with pytest.raises(ValueError, match="one weight per cell: \\(240, 240\\)"):
        curious.trial("four_rooms", Wrong(), seconds=60)
    with pytest.raises(KeyError, match="mine"):
        curious.trial("four_rooms", Raises(), seconds=60)
    with pytest.raises(ValueError, match="at least 1 of `seconds`"):
        curious.trial("four_rooms", seconds=0)
    with pytest.raises(ValueError, match="no strategy is called `best`"):
        curious.trial("four_rooms", "best")
    with pytest.raises(TypeError, match="a strategy is a name"):
        curious.trial("four_rooms", 3)
