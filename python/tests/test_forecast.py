"""A place at another time, from a state of `map_log`, which `.ci/python` puts beside this file."""

import pathlib
from datetime import datetime, timedelta, timezone

import curious
import numpy as np
import pytest

STATE = pathlib.Path(__file__).with_name("place.state")


def test_the_map_at_a_time():
    forecast = curious.Forecast(STATE)
    assert forecast.zone == "UTC" and forecast.now == pytest.approx(1.7e9 + 119.0)
    now = datetime.fromtimestamp(forecast.now, timezone.utc)
    maps = [forecast.probability(time) for time in (forecast.now, now, now + timedelta(hours=1))]
    shape = forecast.mapper.shape
    assert all(map.shape == shape and map.dtype == np.float64 for map in maps)
    np.testing.assert_array_equal(maps[0], maps[1])
    seen = forecast.mapper.states() >= 0
    assert (np.isnan(maps[2]) == ~seen).all() and ((maps[2] >= 0) & (maps[2] <= 1))[seen].all()
    # What stands 1 m before the laser comes and goes every 10 s; nothing else changes.
    changes = (maps[2] > 0.2) & (maps[2] < 0.8)
    assert changes.any() and np.isfinite(forecast.expiry()[changes]).all()
    row, column = np.argwhere(changes)[0]
    origin, cell = forecast.mapper.origin, forecast.mapper.cell
    at = forecast.at(origin[0] + (column + 0.5) * cell, origin[1] + (row + 0.5) * cell, now + timedelta(hours=1))
    assert at == maps[2][row, column] and forecast.at(99.0, 99.0, now) is None
    speed, keepout = forecast.masks(now)
    assert speed.shape == keepout.shape == shape and set(np.unique(keepout)) <= {0, 100}
    assert speed[row, column] > 0 and speed.max() <= 80
    assert forecast.doors() == forecast.doors(now) == []  # what comes and goes there is no door


def test_what_is_no_state_is_an_error(tmp_path):
    with pytest.raises(OSError, match="missing.state"):
        curious.Forecast(tmp_path / "missing.state")
    other = tmp_path / "other"
    other.write_text("x = 1")
    with pytest.raises(ValueError, match="this is not a state file"):
        curious.Forecast(other)
    with pytest.raises(AttributeError, match="timestamp"):
        curious.Forecast(STATE).probability("Tue 17:10")
