"""Fleets and worlds."""

import copy
import json
import os
import pickle
import select
import signal
import threading

import curious
import numpy as np
import pytest


def drive(fleet: curious.Fleet, steps: int = 50) -> np.ndarray:
    count = len(fleet.driven)
    for step in range(steps):
        fleet.step(np.tile([0.4, np.sin(step / 7.0)], (count, 1)))
    return np.concatenate([fleet.scans().ravel(), fleet.poses().ravel()])


def test_scans_and_poses(fleet_toml):
    fleet = curious.Fleet(curious.Spec.from_toml(fleet_toml), seed=3)
    assert (len(fleet), fleet.names, fleet.driven) == (3, ["a", "b", "c"], [0, 1])
    scans = fleet.scans()
    assert scans.shape == (3, 32) and scans.dtype == np.float32
    # Behind robot "a" is the wall at x = 0.1; the noise has 1 cm.
    assert scans[0, 0] == pytest.approx(0.9, abs=0.05)
    assert fleet.poses().tolist()[0] == [1.0, 1.0, 0.0]
    out = np.empty((3, 32), np.float32)
    assert fleet.scans(out=out) is not None
    np.testing.assert_array_equal(out, scans)
    fleet.step([[0.5, 0.0], [0.0, 1.0]], steps=10)
    assert fleet.time == pytest.approx(0.5)
    assert fleet.poses()[0, 0] > 1.05 and fleet.velocities()[1, 2] > 0.9
    reading = fleet.look(0)
    assert reading.time == fleet.time
    np.testing.assert_allclose(reading.pose, fleet.poses()[0])
    np.testing.assert_array_equal(reading.ranges, fleet.scans()[0])


def test_one_call_steps_and_gives_scans_and_poses(fleet_toml):
    spec = curious.Spec.from_toml(fleet_toml)
    one, many = curious.Fleet(spec, seed=3), curious.Fleet(spec, seed=3)
    scans, poses = np.empty((3, 32), np.float32), np.empty((3, 3))
    for step in range(20):
        commands = np.tile([0.4, np.sin(step / 3.0)], (2, 1))
        assert one.step(commands, steps=2, scans=scans, poses=poses) is None
        many.step(commands, steps=2)
        np.testing.assert_array_equal(scans, many.scans())
        np.testing.assert_array_equal(poses, many.poses())
    assert one.snapshot() == many.snapshot()
    assert one.poses(out=poses) is poses
    # Robots with different numbers of beams: one after the other.
    fleet = curious.Fleet("four_rooms")
    total = len(fleet.scans())
    row = np.empty(total, np.float32)
    fleet.step([[0.1, 0.0]], scans=row)
    np.testing.assert_array_equal(row, fleet.scans())
    with pytest.raises(ValueError, match=f"must have \\({total},\\): the robots have different"):
        fleet.step([[0.1, 0.0]], scans=np.empty((2, 720), np.float32))


def test_the_same_seed_is_the_same_run_and_a_reset_a_new_start(fleet_toml):
    spec = curious.Spec.from_toml(fleet_toml)
    fleet = curious.Fleet(spec, seed=3)
    first = drive(fleet)
    fleet.reset(3)
    np.testing.assert_array_equal(drive(fleet), first)
    np.testing.assert_array_equal(drive(curious.Fleet(spec, seed=3, threads=True)), first)
    assert not np.array_equal(drive(curious.Fleet(spec, seed=4)), first)
    fork = fleet.copy()
    np.testing.assert_array_equal(drive(fork), drive(fleet))


def test_snapshots(fleet_toml):
    spec = curious.Spec.from_toml(fleet_toml)
    fleet = curious.Fleet(spec, seed=3)
    drive(fleet)
    snapshot = fleet.snapshot()
    later = drive(fleet)
    fleet.restore(snapshot)
    np.testing.assert_array_equal(drive(fleet), later)
    for damaged in (b"", b"something else", snapshot[:-1], snapshot[:100] + b"x" + snapshot[101:]):
        with pytest.raises(curious.SnapshotError):
            fleet.restore(damaged)
    with pytest.raises(curious.SnapshotError, match="another spec"):
        curious.Fleet("four_rooms").restore(snapshot)


def test_teleport_and_free_poses(fleet_toml):
    fleet = curious.Fleet(curious.Spec.from_toml(fleet_toml), seed=3)
    poses = fleet.free_poses(0, seed=5, count=20)
    np.testing.assert_array_equal(poses, fleet.free_poses(0, seed=5, count=20))
    for pose in poses:
        fleet.teleport(0, pose)
        np.testing.assert_allclose(fleet.poses()[0], pose, atol=1e-6)
    with pytest.raises(ValueError, match="something else"):
        fleet.teleport(0, fleet.poses()[1])
    with pytest.raises(ValueError, match="not within the map"):
        fleet.teleport(0, [100.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda f: f.step(np.zeros((3, 2))), ValueError, "must have \\(2, 2\\)"),
        (lambda f: f.step([[np.nan, 0.0], [0.0, 0.0]]), ValueError, "command NaN of driven robot 0"),
        (lambda f: f.step(np.zeros(4)), ValueError, "shape \\[4\\], and must have \\(2, 2\\)"),
        (lambda f: f.step(np.zeros((2, 2)), steps=-1), ValueError, "`steps` is 0 or more, and not -1"),
        (lambda f: f.step("fast"), (TypeError, ValueError), None),
        (lambda f: f.step(np.zeros((2, 2), complex)), TypeError, "real numbers .*not an array of complex128"),
        (lambda f: f.teleport(0, np.zeros(3, np.complex64)), TypeError, "real numbers .*not an array of complex64"),
        (lambda f: f.command(9, 0.0, 0.0), IndexError, "there is no robot 9: there are 3"),
        (lambda f: f.command(0, np.inf, 0.0), ValueError, "finite"),
        (lambda f: f.look(3), IndexError, "there is no robot 3"),
        (lambda f: f.scans(out=np.empty((3, 31), np.float32)), ValueError, "must have \\(3, 32\\)"),
        (lambda f: f.step(np.zeros((2, 2)), scans=np.empty(96, np.float32)), ValueError, "must have \\(3, 32\\)"),
        (lambda f: f.step(np.zeros((2, 2)), scans=np.empty((3, 32))), TypeError, "array of float32 .*not an array of float64"),
        (lambda f: f.step(np.zeros((2, 2)), scans=[1.0]), TypeError, "`scans` must be a writable array of float32"),
        (lambda f: f.step(np.zeros((2, 2)), poses=np.empty((3, 2))), ValueError, "must have \\(3, 3\\)"),
        (lambda f: f.step(np.zeros((2, 2)), poses=np.empty((3, 3)).T), ValueError, "C order"),
        (lambda f: f.scans(out=np.empty((32, 3), np.float32).T), ValueError, "C order"),
        (lambda f: f.scans(out=np.empty((3, 32), np.float64)), TypeError, None),
        (lambda f: f.run(-1.0), ValueError, "0 s or more"),
        (lambda f: f.run(np.nan), ValueError, "0 s or more"),
        (lambda f: f.teleport(0, [[1.0, 2.0, 0.0]]), TypeError, "one row of numbers is needed, and not list"),
        (lambda f: f.teleport(0, np.zeros((1, 3))), TypeError, "not an array of float64 of shape \\[1, 3\\]"),
        (lambda f: f.teleport(0, [1.0, 2.0]), ValueError, "a pose is \\[x, y, heading\\]"),
        (lambda f: f.teleport(0, [1.0, 2.0, np.nan]), ValueError, "finite"),
        (lambda f: f.reset(-1), ValueError, "a whole number from 0 to 2\\^64 - 1 is needed, and not -1"),
        (lambda f: f.reset(1 << 64), ValueError, "and not 18446744073709551616"),
        (lambda f: f.look(-1), IndexError, "an index is counted from 0, and cannot be -1"),
        (lambda f: f.free_poses(0, 1, 1 << 50), ValueError, "at most 10000000 poses"),
    ],
)
def test_invalid_input_is_refused_and_changes_nothing(fleet_toml, call, error, message):
    fleet = curious.Fleet(curious.Spec.from_toml(fleet_toml), seed=3)
    before = fleet.snapshot()
    with pytest.raises(error, match=message):
        call(fleet)
    assert fleet.snapshot() == before


def test_worlds_from_everywhere(tmp_path, fleet_toml):
    assert "four_rooms" in curious.Spec.shipped()
    house = curious.Spec.house(7)
    assert house.name == "house-7" and house.driven == [0]
    for spec in (curious.Spec.load("office"), curious.Spec.driving_hall(), curious.Spec.from_toml(fleet_toml)):
        assert pickle.loads(pickle.dumps(spec)) == spec != house
    for same in (pickle.loads(pickle.dumps(house)), copy.deepcopy(house)):
        assert same == house and same != curious.Spec.house(8)
    again = curious.Spec.from_toml(house.to_toml())
    assert again.robots == house.robots and again.shape == house.shape
    path = tmp_path / "mine.toml"
    path.write_text(fleet_toml)
    assert curious.Fleet(path).names == ["a", "b", "c"]
    stage = tmp_path / "yard.world"
    stage.write_text('define r position ( size [0.4 0.4 0.3] blobfinder ()\n'
                     '  ranger ( sensor ( range [0 5] fov 180 samples 19 ) ) )\n'
                     'model ( size [4 0.2 1] pose [0 2 0 0] )\nr ( pose [0 0 0 0] name "one" )\n')
    with pytest.warns(UserWarning) as warned:
        fleet = curious.Fleet(curious.Spec.from_stage(stage))
    assert all("yard.world" in str(warning.message) for warning in warned)
    assert fleet.names == ["one"]


def test_errors_are_those_of_the_command_line(tmp_path):
    with pytest.raises(curious.WorldError) as error:
        curious.Spec.from_toml("name = 3\n[map]\nsize_m = [4.0, -1.0]\n", name="mine.toml")
    text = str(error.value)
    assert "mine.toml:1" in text and "mine.toml:3" in text and "help" in text
    with pytest.raises(FileNotFoundError, match="neither a file nor one of those that ship"):
        curious.Fleet("no_such_world")
    broken = tmp_path / "broken.world"
    broken.write_text("model ( size [1 1 1 )\n")
    with pytest.raises(curious.WorldError, match="broken.world:1"):
        curious.Spec.load(broken)
    with pytest.raises(curious.WorldError, match="`two_blocks` is a grid world: the program `grid_world` runs it"):
        curious.Spec.load("two_blocks")
    with pytest.raises(TypeError, match="a world is a spec, the name of a shipped world, or a path, and not int"):
        curious.Fleet(3)
    with pytest.raises(FileNotFoundError):
        curious.Spec.from_stage(tmp_path / "nothing.world")


def test_a_world_has_ground_truth():
    world = curious.World("four_rooms", seed=1)
    for _ in range(100):
        world.act(0.5, 0.3)
    states, rates = world.true_states(), world.true_rates()
    assert states.shape == rates.shape == (240, 240) and set(np.unique(states)) <= {-1, 0, 1}
    assert states[0, 0] == 1 and rates.max() > 0.0
    reading = world.sense()
    np.testing.assert_allclose(reading.pose, world.true_pose, atol=1e-9)


def test_a_world_has_one_driven_robot(fleet_toml):
    spec = curious.Spec.from_toml(fleet_toml)
    with pytest.raises(curious.WorldError, match="more than one robot is driven"):
        curious.World(spec)
    assert curious.World(spec, robot=1).driven == 1
    with pytest.raises(IndexError):
        curious.World(spec, robot=3)


def test_threads_at_the_same_time():
    fleets = [curious.Fleet("four_rooms", seed=5) for _ in range(4)]
    threads = [threading.Thread(target=fleet.run, args=(30.0,)) for fleet in fleets]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({fleet.snapshot() for fleet in fleets}) == 1


def test_forked_process_has_its_own_threads():
    """The threads of another process do not exist in a forked one, which would wait for them for ever."""
    if not hasattr(os, "fork"):
        pytest.skip("this system does not fork")

    def drive(fleet: curious.Fleet) -> list[float]:
        fleet.step(steps=40, scans=fleet.scans())
        return fleet.poses().ravel().tolist()

    before = curious.Fleet("house", 3, threads=True)
    expected = drive(before)
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        drive(before)
        os.write(writer, json.dumps(drive(curious.Fleet("house", 3, threads=True))).encode())
        os._exit(0)
    os.close(writer)
    ready, _, _ = select.select([reader], [], [], 60)
    if not ready:
        os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    assert ready and json.loads(os.read(reader, 1 << 20)) == expected


def test_output_replaces_only_its_own_files(tmp_path):
    path = tmp_path / "a.txt"
    for text in ("one", "two"):
        with curious.Output(path) as file:
            file.write_text(text)
        assert path.read_text() == text
    with pytest.raises(ZeroDivisionError):
        with curious.Output(path) as file:
            file.write_text("half")
            1 / 0
    assert path.read_text() == "two" and not file.exists()
    path.write_text("edited")
    with pytest.raises(FileExistsError, match="it was changed since a run wrote it"):
        curious.Output(path)
    assert path.read_text() == "edited"
