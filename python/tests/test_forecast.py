"""A place at another time, from states of `map_log` and of `four_rooms`, which `.ci/python` puts beside this file."""

import pathlib
from datetime import datetime, timedelta, timezone

import curious
import numpy as np
import pytest

STATE = pathlib.Path(__file__).with_name("place.state")
UNDATED = STATE.with_name("undated.state")


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


def test_what_is_no_time_is_an_error():
    dated, undated = curious.Forecast(STATE), curious.Forecast(UNDATED)
    assert dated.zone == "UTC" and undated.zone is None
    calls = [
        lambda forecast, time: forecast.probability(time),
        lambda forecast, time: forecast.at(0.0, 0.0, time),
        lambda forecast, time: forecast.doors(time),
        lambda forecast, time: forecast.masks(time),
    ]
    for call in calls:
        for forecast in (dated, undated):
            call(forecast, forecast.now + 60.0)
            with pytest.raises(ValueError, match="the time is NaN"):
                call(forecast, float("nan"))
        with pytest.raises(ValueError, match=r"the state knows no hours .* give a time in seconds, as `now`, which is \d+"):
            call(undated, datetime(2026, 1, 1, tzinfo=timezone.utc))
