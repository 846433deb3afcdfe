"""Damaged snapshots are refused, and change nothing."""

import curious
import numpy as np
import pytest


def a_mapper():
    world = curious.World("four_rooms", 3)
    mapper = world.mapper()
    for _ in range(20):
        world.act(0.5, 0.3)
        mapper.update_reading(world.sense())
    return mapper


def an_environment():
    batch = curious.Batch.drive(curious.Spec.house(1003), 1, 1, shows_memory=True)
    batch.reset(np.zeros(1, np.uint64))
    for _ in range(20):
        batch.step(np.full((1, 2), 0.5, np.float32), np.zeros(1, np.uint64))
    return batch


def at(thing):
    """What names the environment of a batch."""
    return [0] if isinstance(thing, curious.Batch) else []


def restore(thing, snapshot):
    thing.restore(*at(thing), snapshot)


@pytest.mark.parametrize("make", [a_mapper, an_environment])
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
        mapper.restore(an_environment().snapshot())
    before = mapper.snapshot()
    with pytest.raises(curious.SnapshotError, match="a map with other cells or another estimator"):
        mapper.restore(curious.Mapper(2.0, 2.0).snapshot())
    assert mapper.snapshot() == before


def of_another_build(snapshot):
    """The same snapshot as another build seals it."""
    xxhash = pytest.importorskip("xxhash")
    body = snapshot[:8] + b"0123456789abcdef" + snapshot[24:-8]
    return body + xxhash.xxh3_64_intdigest(body).to_bytes(8, "little")


def test_the_bits_of_another_build_are_promised_to_nobody():
    thing = an_environment()
    snapshot = thing.snapshot()
    other = of_another_build(snapshot)
    thing.restore(*at(thing), snapshot)
    why = (
        r"the snapshot was taken by another build \(0123456789abcdef, this one is [0-9a-f]{16}\), whose results can differ; "
        r"allow_other_build=True takes it"
    )
    with pytest.raises(curious.SnapshotError, match=why):
        thing.restore(*at(thing), other)
    thing.restore(*at(thing), other, allow_other_build=True)
    assert thing.snapshot() == snapshot


def test_what_another_build_has_learned_is_taken():
    thing = a_mapper()
    snapshot = thing.snapshot()
    thing.restore(of_another_build(snapshot))
    assert thing.snapshot() == snapshot
