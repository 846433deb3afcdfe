"""Damaged snapshots are refused, and change nothing."""

import curious
import numpy as np
import pytest


def a_world():
    world = curious.World("four_rooms", 3)
    for _ in range(20):
        world.act(0.5, 0.3)
    return world


def a_mapper():
    world = a_world()
    mapper = world.mapper()
    for _ in range(20):
        world.act(0.5, 0.3)
        mapper.update_reading(world.sense())
    return mapper


def a_localizer():
    world, mapper = a_world(), a_mapper()
    localizer = curious.Localizer(mapper, world.true_pose)
    localizer.localize(world.sense(), mapper)
    return localizer


def an_environment():
    batch = curious.Batch.explore([curious.Spec.house(1003)], 1, 1)
    batch.reset(np.zeros(1, np.uint64))
    for _ in range(20):
        batch.step(np.full((1, 2), 0.5, np.float32), np.zeros(1, np.uint64))
    return batch


def restore(thing, snapshot):
    if isinstance(thing, curious.Batch):
        thing.restore(0, snapshot)
    else:
        thing.restore(snapshot)


@pytest.mark.parametrize("make", [a_world, a_mapper, a_localizer, an_environment])
def test_damage_is_found_anywhere(make):
    thing = make()
    snapshot = thing.snapshot()
    random = np.random.default_rng(1)
    for _ in range(50):
        at = int(random.integers(len(snapshot)))
        flipped = snapshot[:at] + bytes([snapshot[at] ^ 1 << int(random.integers(8))]) + snapshot[at + 1 :]
        for damaged in (flipped, snapshot[:at], snapshot + b"x"):
            with pytest.raises(curious.SnapshotError):
                restore(thing, damaged)
    assert thing.snapshot() == snapshot
    restore(thing, snapshot)
    assert thing.snapshot() == snapshot


def test_snapshots_of_something_else():
    mapper = a_mapper()
    with pytest.raises(curious.SnapshotError, match=r"not a snapshot of this kind \(mapper\)"):
        mapper.restore(a_localizer().snapshot())
    before = mapper.snapshot()
    with pytest.raises(curious.SnapshotError, match="a map with other cells or another estimator"):
        mapper.restore(curious.Mapper(2.0, 2.0).snapshot())
    assert mapper.snapshot() == before
