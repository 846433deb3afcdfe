"""The environments."""

import copy
import pickle
import warnings

import curious
import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")
from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.vector import AutoresetMode  # noqa: E402

GOALS = "curious/ExploreGoals-v0"
VELOCITIES = ["curious/Drive-v0", "curious/Explore-v0", "curious/Explore-v1"]
NAMES = [*VELOCITIES, GOALS]
SMALL = {
    "curious/Drive-v0": {"max_steps": 25},
    "curious/Explore-v0": {"worlds": [curious.Spec.house(1), curious.Spec.house(4)], "max_steps": 25, "beams": 60},
    "curious/Explore-v1": {"houses": range(3), "max_steps": 25, "beams": 60, "shows_local_map": True, "local_map_cells": 12},
    GOALS: {"houses": range(3), "max_steps": 150, "beams": 60, "max_goal_s": 3.0, "shows_local_map": True, "shows_routes": True},
}


def flat(observation) -> np.ndarray:
    parts = observation.values() if isinstance(observation, dict) else [observation]
    return np.concatenate([np.asarray(part).ravel() for part in parts])


def action(environment: int, step: int, name: str = "") -> np.ndarray:
    if name == GOALS:
        return np.int64((environment + step) % 8)
    return np.array([np.cos(environment + 0.1 * step), np.sin(environment * 1.7 + 0.3 * step)], np.float32)


@pytest.mark.parametrize("name", NAMES)
def test_check_env_has_no_warning(name):
    # Warnings are errors in this suite.
    env = gymnasium.make(name, render_mode="rgb_array", **SMALL[name])
    check_env(env.unwrapped)
    env.close()


@pytest.mark.parametrize("name", NAMES)
def test_a_vector_environment_has_the_bits_of_single_ones(name):
    count, steps = 5, 16 if name == GOALS else 70
    vector = gymnasium.make_vec(name, num_envs=count, vectorization_mode="vector_entry_point", **SMALL[name])
    assert vector.metadata["autoreset_mode"] == AutoresetMode.SAME_STEP
    alone = type(vector.unwrapped)(num_envs=count, threads=1, **SMALL[name])
    single = gymnasium.make(name, **SMALL[name])
    rows, info = vector.reset(seed=40)
    rows_alone, _ = alone.reset(seed=40)
    np.testing.assert_array_equal(flat(rows), flat(rows_alone))
    recorded, ends = [], 0
    seeds = [int(info["world_seed"][2])]
    for step in range(steps):
        actions = np.stack([action(index, step, name) for index in range(count)])
        rows, rewards, terminated, truncated, info = vector.step(actions)
        rows_alone, rewards_alone, *_ = alone.step(actions)
        np.testing.assert_array_equal(flat(rows), flat(rows_alone))
        np.testing.assert_array_equal(rewards, rewards_alone)
        of_two = {key: part[2] for key, part in rows.items()} if isinstance(rows, dict) else rows[2]
        ended = bool(terminated[2] or truncated[2])
        last = info["final_obs"][2] if ended else of_two
        recorded.append((flat(last), rewards[2], terminated[2], truncated[2]))
        if ended:
            ends += 1
            assert info["_final_obs"][2] and info["_final_info"][2]
            assert int(info["final_info"]["world_seed"][2]) == seeds[-1]
            seeds.append(int(info["world_seed"][2]))
    assert ends >= 2
    observation, info = single.reset(seed=42)
    episode = 0
    for step in range(steps):
        assert info["world_seed"] == seeds[episode]
        observation, reward, terminated, truncated, info = single.step(action(2, step, name))
        expected = recorded[step]
        np.testing.assert_array_equal(flat(observation), expected[0])
        assert (np.float32(reward), terminated, truncated) == (np.float32(expected[1]), expected[2], expected[3])
        if terminated or truncated:
            episode += 1
            observation, info = single.reset()
    # A world can be repeated by its seed alone.
    again, _ = single.reset(options={"world_seed": seeds[0]})
    first, _ = single.reset(seed=42)
    np.testing.assert_array_equal(flat(again), flat(first))


@pytest.mark.parametrize("name", NAMES)
def test_snapshots_and_pictures(name):
    env = gymnasium.make(name, render_mode="rgb_array", **SMALL[name]).unwrapped
    world_seed = env.reset(seed=1)[1]["world_seed"]
    for step in range(5):
        env.step(action(0, step, name))
    snapshot, picture = env.snapshot(), env.render()
    assert picture.dtype == np.uint8 and picture.shape[2] == 3 and max(picture.shape) == 480
    expected = [flat(env.step(action(0, step, name))[0]) for step in range(5, 10)]
    assert not np.array_equal(env.render(), picture)
    env.reset(seed=2)
    env.restore(snapshot)
    np.testing.assert_array_equal(env.render(), picture)
    for step in range(5, 10):
        observation, _, _, _, info = env.step(action(0, step, name))
        np.testing.assert_array_equal(flat(observation), expected[step - 5])
        assert info["world_seed"] == world_seed
    many = gymnasium.make_vec(name, num_envs=2, **SMALL[name]).unwrapped
    many.reset(seed=5)
    many.restore(1, snapshot)
    info = many.step(np.stack([action(0, 5, name)] * 2))[4]
    # Where the step ends the episode, the seed in `info` is that of the next one.
    seeds = info.get("final_info", info)["world_seed"]
    assert seeds[1] == world_seed != seeds[0]
    with pytest.raises(curious.SnapshotError):
        env.restore(snapshot[:-3])


@pytest.mark.parametrize("name", VELOCITIES)
def test_invalid_actions_are_refused(name):
    env = gymnasium.make(name, **SMALL[name]).unwrapped
    with pytest.raises(RuntimeError, match="call reset"):
        env.step([0.0, 0.0])
    env.reset(seed=1)
    before = env.snapshot()
    for invalid, message in [
        ([np.nan, 0.0], "action NaN of environment 0"),
        ([0.0, 1.5], "action 1.5 of environment 0 is not from -1 to 1"),
        ([0.0, 0.0, 0.0], "shape"),
        (0.5, "shape"),
        ("fast", "actions are real numbers, and not"),
        (np.zeros(2, complex), "actions are real numbers, and not complex128"),
    ]:
        with pytest.raises((ValueError, TypeError), match=message):
            env.step(invalid)
    assert env.snapshot() == before
    env.close()
    env.close()
    for call in (env.reset, lambda: env.step([0.0, 0.0]), env.snapshot):
        with pytest.raises(gymnasium.error.ClosedEnvironmentError):
            call()
    vector = gymnasium.make_vec(name, num_envs=2, vectorization_mode="vector_entry_point", **SMALL[name])
    vector.reset(seed=[3, 4])
    with pytest.raises(ValueError, match="environment 1"):
        vector.step(np.array([[0.0, 0.0], [0.0, 2.0]]))
    with pytest.raises(ValueError, match="shape"):
        vector.step(np.zeros((3, 2)))
    with pytest.raises(ValueError, match="3 seeds for 2"):
        vector.reset(seed=[1, 2, 3])
    for seed in ("ab", 1.5):
        with pytest.raises(TypeError, match="a seed is a whole number or a list of them"):
            vector.reset(seed=seed)
    with pytest.raises(ValueError, match="1 seeds of worlds for 2"):
        vector.reset(options={"world_seed": [3]})
    vector.close()


@pytest.mark.parametrize("name", NAMES)
def test_worlds_are_repeated_by_their_seeds(name):
    vector = gymnasium.make_vec(name, num_envs=2, vectorization_mode="vector_entry_point", **SMALL[name])

    def run(**keywords) -> tuple[np.ndarray, np.ndarray]:
        observation, info = vector.reset(**keywords)
        rows = [flat(observation)]
        for step in range(4 if name == GOALS else 15):
            rows.append(flat(vector.step(np.stack([action(0, step, name), action(1, step, name)]))[0]))
        return info["world_seed"], np.concatenate(rows)

    seeds, first = run(seed=7)
    others, _ = run()
    assert (seeds != others).all()
    repeated, again = run(options={"world_seed": seeds})
    np.testing.assert_array_equal(seeds, repeated)
    np.testing.assert_array_equal(first, again)
    env = gymnasium.make(name, **SMALL[name])
    assert env.reset(options={"world_seed": seeds[1]})[1]["world_seed"] == seeds[1]
    for seed, error in ((-1, ValueError), (1 << 64, ValueError), (1.5, TypeError), ("x", TypeError)):
        with pytest.raises(error):
            env.reset(options={"world_seed": seed})


def test_invalid_choices_are_refused():
    env = gymnasium.make(GOALS, **SMALL[GOALS]).unwrapped
    assert env.action_space == gymnasium.spaces.Discrete(8)
    env.reset(seed=1)
    before = env.snapshot()
    for invalid, message in [
        (8, "action 8 of environment 0 is not a whole number from 0 to 7"),
        (0.5, "action 0.5 of environment 0 is not a whole number"),
        ([0, 1], "shape"),
        ("frontier", "actions are real numbers"),
    ]:
        with pytest.raises((ValueError, TypeError), match=message):
            env.step(invalid)
    assert env.snapshot() == before
    with pytest.raises(ValueError, match="no strategy is called `east`"):
        gymnasium.make(GOALS, strategies=["east"])
    with pytest.raises(ValueError, match="at least one strategy"):
        gymnasium.make(GOALS, strategies=[])
    with pytest.raises(ValueError, match="max_goal_s"):
        gymnasium.make(GOALS, max_goal_s=0.0)


def test_episodes_begin_anywhere_in_many_houses():
    env = gymnasium.make("curious/Explore-v1", beams=20, max_steps=1)
    starts = {tuple(env.reset(seed=seed)[0]["state"].tolist()) for seed in range(20)}
    houses = {int(env.reset(seed=seed)[1]["world_seed"]) for seed in range(20)}
    assert len(starts) == 20 and len(houses) == 20
    assert not set(curious.envs.TRAIN_HOUSES) & set(curious.envs.TEST_HOUSES)
    numbers = set()
    for seed in range(12):
        env = gymnasium.make("curious/Explore-v1", houses=range(2, 5), beams=20, max_steps=1)
        env.reset(seed=seed)
        numbers.add(env.step(np.zeros(2, np.float32))[4]["world"])
    assert numbers == {0.0, 1.0, 2.0}
    with pytest.raises(TypeError, match="in `worlds` or in `houses`, not in both"):
        gymnasium.make("curious/Explore-v1", houses=range(2), worlds="house")
    with pytest.raises(ValueError, match="the setting `reward` is one of found, updates, and not more"):
        gymnasium.make("curious/Explore-v1", houses=range(2), reward="more")


@pytest.mark.parametrize("name", NAMES)
def test_a_deep_copy_goes_on_with_the_same_bits(name):
    env = gymnasium.make(name, **SMALL[name])
    env.reset(seed=3)
    env.step(action(0, 0, name))
    other = copy.deepcopy(env)
    for step in range(1, 4):
        one, two = (each.step(action(0, step, name)) for each in (env, other))
        np.testing.assert_array_equal(flat(one[0]), flat(two[0]))
        assert one[1] == two[1]
    np.testing.assert_array_equal(flat(env.reset()[0]), flat(other.reset()[0]))
    for refused in (copy.copy, pickle.dumps):
        with pytest.raises(TypeError, match="cannot be pickled: make another one"):
            refused(env.unwrapped)
    vector = gymnasium.make_vec(name, num_envs=2, vectorization_mode="vector_entry_point", **SMALL[name]).unwrapped
    vector.reset(seed=3)
    actions = np.stack([action(0, 0, name), action(1, 0, name)])
    vector.step(actions)
    again = copy.deepcopy(vector)
    np.testing.assert_array_equal(flat(vector.step(actions)[0]), flat(again.step(actions)[0]))


@pytest.mark.parametrize("name", NAMES)
def test_the_values_of_observations_have_names(name):
    env = gymnasium.make(name, **SMALL[name]).unwrapped
    observation, _ = env.reset(seed=1)
    if name == "curious/Drive-v0":
        assert env.slices["scan"] == slice(0, 64) and env.slices["velocity"] == slice(69, 71)
        parts = [(observation, env.slices, ("goal_direction", "path_direction"))]
    else:
        parts = [(observation["state"], env.slices["state"], ("heading",))]
    for values, slices, directions in parts:
        assert sum(values[of].size for of in slices.values()) == values.size
        for direction in directions:
            assert np.hypot(*values[slices[direction]]) == pytest.approx(1.0, abs=1e-5)
    if name == GOALS:
        assert sum(of.stop - of.start for of in env.slices["candidates"].values()) == 9
        # A robot at the start has its surroundings in view, and the rest is unseen.
        assert observation["candidates"][0, env.slices["candidates"]["unseen"]] > 0.0


@pytest.mark.parametrize("name", ["curious/Explore-v1", GOALS])
def test_a_local_map_is_an_option_with_named_layers(name):
    settings = {"houses": range(3), "max_steps": 300, "beams": 60}
    plain = gymnasium.make(name, **settings).unwrapped
    env = gymnasium.make(name, shows_local_map=True, local_map_cells=20, local_map_cell=0.5, **settings).unwrapped
    steps = 3 if name == GOALS else 60
    for each in (plain, env):
        each.reset(seed=5)
    for step in range(steps):
        without, with_map = (each.step(action(0, step, name))[0] for each in (plain, env))
        for part, values in without.items():
            np.testing.assert_array_equal(values, with_map[part])
    assert "local_map" not in without and with_map["local_map"].shape == (7, 20, 20)
    assert env.observation_space["local_map"].contains(with_map["local_map"])
    layers = {layer: with_map["local_map"][of][0] for layer, of in env.slices["local_map"].items()}
    assert list(layers) == ["free", "blocked", "unknown", "frontier", "age", "changed", "rate"]
    # In each of the middle cells one point of four is under the robot. Every point is in one state, and unknown points beside
    # free ones are the frontier.
    assert layers["free"][9:11, 9:11].min() >= 0.25
    states = layers["free"] + layers["blocked"] + layers["unknown"]
    assert set(np.unique(states)) <= {0.0, 0.25, 0.5, 0.75, 1.0} and states.max() == 1.0
    assert (layers["frontier"] <= layers["unknown"]).all() and layers["frontier"].any()
    assert (layers["age"][layers["unknown"] == 1.0] == 1.0).all() and layers["age"][10, 10] < 0.1
    with pytest.raises(ValueError, match="local_map_cells"):
        gymnasium.make(name, local_map_cells=1)


def test_routes_are_an_option_with_named_values():
    settings = {"houses": range(3), "max_steps": 300, "beams": 60}
    plain, env = (gymnasium.make(GOALS, shows_routes=shows, **settings).unwrapped for shows in (False, True))
    for each in (plain, env):
        each.reset(seed=5)
    for step in range(3):
        without, with_routes = (each.step(action(0, step, GOALS))[0] for each in (plain, env))
        for part, values in without.items():
            np.testing.assert_array_equal(values, with_routes[part])
    assert "routes" not in without and env.observation_space["routes"].contains(with_routes["routes"])
    assert list(env.slices["routes"]) == ["travel", "gap", "unseen", "stale", "age", "expected_changes", "changing"]
    direct, route = (with_routes[part][:, env.slices[part]["travel"]] for part in ("candidates", "routes"))
    # Every route ends where the robot can go; that of a goal with a path is the same.
    assert (route < 1.0).all()
    np.testing.assert_array_equal(route[direct < 1.0], direct[direct < 1.0])
    with pytest.raises(TypeError, match="stays_at_goals"):
        gymnasium.make(GOALS, stays_at_goals="no")


def test_every_task_counts_contacts():
    for name in NAMES:
        env = gymnasium.make(name, **SMALL[name]).unwrapped
        _, info = env.reset(seed=1)
        assert info["collisions"] == 0 and isinstance(info["collisions"], int), name
        info = env.step(action(0, 0, name))[4]
        assert info["collisions"] >= 0 and isinstance(info["collisions"], int), name
    for name in ("curious/Drive-v0", "curious/Explore-v1"):
        # A robot that always drives straight on meets a wall, and stays there: one contact, not one per step.
        env = gymnasium.make(name, collision_reward=-100.0, max_steps=200).unwrapped
        env.reset(seed=2)
        counts, rewards = [0], []
        for _ in range(200):
            _, reward, terminated, truncated, info = env.step(np.array([1.0, 0.0], np.float32))
            counts.append(info["collisions"])
            rewards.append(reward)
        new = np.diff(counts)
        assert counts[-1] > 0 and (new >= 0).all() and counts[-1] < 100
        np.testing.assert_array_equal(new, np.round(np.minimum(rewards, 0.0) / -100.0))


def test_render_without_a_mode_says_so():
    env = gymnasium.make("curious/Drive-v0").unwrapped
    env.reset(seed=1)
    with pytest.warns(UserWarning, match="render.. needs render_mode"):
        assert env.render() is None
    vector = gymnasium.make_vec("curious/Drive-v0", num_envs=2, vectorization_mode="vector_entry_point").unwrapped
    with pytest.warns(UserWarning, match="render.. needs render_mode"):
        assert vector.render() is None


def test_a_window_opens_no_audio_device(monkeypatch):
    pygame = pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    env = gymnasium.make("curious/Drive-v0", render_mode="human").unwrapped
    env.reset(seed=1)
    assert pygame.display.get_init() and pygame.mixer.get_init() is None
    env.close()
    assert not pygame.display.get_init()


def test_settings():
    with pytest.raises(TypeError, match="`threads` is for many environments"):
        gymnasium.make("curious/Drive-v0", threads=2)
    with pytest.raises(TypeError, match="`worlds` is a list of worlds or one world, and not int"):
        gymnasium.make("curious/Explore-v0", worlds=5)
    with pytest.raises(ValueError, match="render_mode must be one of"):
        curious.envs.DriveVectorEnv(2, render_mode="human")
    with pytest.raises(TypeError, match="no setting `speed`; there are decision_s"):
        gymnasium.make("curious/Drive-v0", speed=3)
    with pytest.raises(ValueError, match="goal_radius_m"):
        gymnasium.make("curious/Drive-v0", goal_radius=-1.0)
    with pytest.raises(ValueError, match="the setting `max_steps` cannot be -5"):
        gymnasium.make("curious/Drive-v0", max_steps=-5)
    with pytest.raises(TypeError, match="the setting `goal_radius` cannot be wide"):
        gymnasium.make("curious/Drive-v0", goal_radius="wide")
    with pytest.raises(FileNotFoundError, match="there is no world `hut`"):
        gymnasium.make("curious/Explore-v0", worlds="hut")
    with pytest.raises(ValueError, match="number of environments"):
        curious.Batch.drive(curious.Spec.driving_hall(), 0)
    with pytest.raises(ValueError, match="at least one world"):
        gymnasium.make("curious/Explore-v0", worlds=[])
    env = gymnasium.make("curious/Drive-v0", world="house", decision_s=0.2, min_goal=4.0)
    observation, _ = env.reset(seed=1)
    assert observation.shape == (727,)
    batch = env.unwrapped.batch
    assert np.hypot(*(np.array(batch.goal()) - batch.poses()[0, :2])) >= 4.0


def test_the_path_leads_to_the_goal():
    env = gymnasium.make_vec("curious/Drive-v0", num_envs=64, vectorization_mode="vector_entry_point")
    rows, _ = env.reset(seed=0)
    success, is_over = np.zeros(64, bool), np.zeros(64, bool)
    while not is_over.all():
        cos, sin, near = rows[:, -4], rows[:, -3], rows[:, 28:37].min(axis=1)
        turn = np.clip(1.2 * np.arctan2(sin, cos), -1.0, 1.0)
        speed = np.where(cos < 0.5, 0.0, np.clip(4.0 * near - 0.2, 0.1, 1.0) * cos)
        rows, _, terminated, truncated, info = env.step(np.stack([speed, turn], axis=1).clip(-1.0, 1.0))
        success |= terminated & ~is_over
        is_over |= terminated | truncated
        if terminated.any():
            final = info["final_info"]
            assert (final["is_success"] == terminated)[final["_is_success"]].all()
    assert success.mean() >= 0.9


def test_pettingzoo(fleet_toml):
    pettingzoo = pytest.importorskip("pettingzoo")
    from curious.pettingzoo import DriveParallelEnv

    with warnings.catch_warnings():
        # The import itself warns in some versions.
        warnings.simplefilter("ignore")
        from pettingzoo.test import parallel_api_test, parallel_seed_test

    def make() -> pettingzoo.ParallelEnv:
        spec = curious.Spec.from_toml(fleet_toml)
        return DriveParallelEnv(spec, render_mode="rgb_array", max_steps=50, min_goal=1.0)

    parallel_api_test(make(), num_cycles=200)
    parallel_seed_test(make)
    env = make()
    observations, infos = env.reset(seed=1)
    assert set(observations) == {"a", "b"} and env.render().shape[2] == 3
    _, _, _, _, after = env.step({"a": [0.0, 0.0], "b": [0.0, 0.0]})
    assert [info.keys() for info in infos.values()] == [info.keys() for info in after.values()]
    with pytest.raises(ValueError, match="no action for b"):
        env.step({"a": [0.0, 0.0]})
    with pytest.raises(ValueError, match="a: the actions have the shape"):
        env.step({"a": [0.0], "b": [0.0, 0.0]})
    for value in (2.0, np.nan):
        with pytest.raises(ValueError, match="b: action .* is not from -1 to 1"):
            env.step({"a": [0.0, 0.0], "b": [value, 0.0]})


@pytest.mark.parametrize("name", ["Drive", "Explore"])
def test_stable_baselines3(name, tmp_path):
    pytest.importorskip("stable_baselines3")
    from curious import envs
    from curious.sb3 import SB3VecEnv
    from stable_baselines3 import PPO
    from stable_baselines3.common.evaluation import evaluate_policy

    settings = {"max_steps": 20} if name == "Drive" else {**SMALL["curious/Explore-v0"], "max_steps": 20}
    make, policy = getattr(envs, f"{name}VectorEnv"), "MlpPolicy" if name == "Drive" else "MultiInputPolicy"
    env = SB3VecEnv(make(num_envs=4, **settings))
    env.seed(3)
    first = env.reset()
    for _ in range(20):
        observations, rewards, dones, infos = env.step(np.zeros((4, 2), np.float32))
    assert rewards.shape == (4,) and dones.all() and all(info["TimeLimit.truncated"] for info in infos)
    assert infos[0]["episode"]["l"] == 20
    if name == "Drive":
        # The last observation of an episode, and the first one of the next.
        assert not np.array_equal(infos[0]["terminal_observation"], observations[0])
    # The same seed is the same start.
    env.seed(3)
    np.testing.assert_array_equal(flat(env.reset()), flat(first))
    model = PPO(policy, env, n_steps=16, batch_size=64, n_epochs=1, device="cpu", seed=0)
    model.learn(128)
    model.save(tmp_path / "model")
    again = PPO.load(tmp_path / "model", env=env, device="cpu")
    action, _ = again.predict(env.reset(), deterministic=True)
    assert action.shape == (4, 2) and np.abs(action).max() <= 1.0
    returns, lengths = evaluate_policy(again, env, n_eval_episodes=4, return_episode_rewards=True)
    assert lengths == [20] * 4 and np.isfinite(returns).all()


#: The numbers of `golden_hashes` in `environments/tests/tasks.rs`.
GOLDEN = {"drive": 6763501705012223895, "explore": 17686607519096061081}


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("kind", GOLDEN)
def test_python_and_rust_give_the_same_bits(kind, threads):
    if kind == "drive":
        batch = curious.Batch.drive(curious.Spec.driving_hall(), 3, threads, max_steps=40)
    else:
        houses = [curious.Spec.house(3), curious.Spec.house(5)]
        batch = curious.Batch.explore(houses, 2, threads, max_steps=40, beams=20, reward="updates", starts="spec")
    count, value = batch.environments, 0xCBF29CE484222325
    batch.reset(np.arange(count, dtype=np.uint64))
    for step in range(60):
        actions = np.float32((np.arange(2 * count) * 7 + step * 3) % 17) / np.float32(8.0) - np.float32(1.0)
        seeds = np.arange(100 + step, 100 + step + count, dtype=np.uint64)
        observations, rewards, *_ = batch.step(actions.reshape(count, 2), seeds)
        for bits in np.concatenate([observations.ravel(), rewards]).view(np.uint32).tolist():
            value = ((value ^ bits) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    assert value == GOLDEN[kind]


def test_drive_has_a_memory_with_names():
    env = gymnasium.make("curious/Drive-v0", shows_path=False, shows_memory=True).unwrapped
    observation, _ = env.reset(seed=4)
    assert observation.shape == (64 + 7 + 128,) == env.observation_space.shape
    visited, seen = (observation[env.slices[name]] for name in ("visited", "seen"))
    assert visited.shape == seen.shape == (64,)
    assert (observation[env.slices["path_direction"]] == 0.0).all()
    # At first the robot was nowhere but where it is; beyond the world both are 1.
    assert visited[:16].max() < 0.1 and seen.mean() > 0.1
    for _ in range(30):
        observation, *_ = env.step(np.array([0.0, 0.0], np.float32))
    other = copy.deepcopy(env)
    action_of = np.array([1.0, 0.2], np.float32)
    np.testing.assert_array_equal(env.step(action_of)[0], other.step(action_of)[0])
