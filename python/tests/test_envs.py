"""The environment, one and many."""

import copy
import pickle
import warnings

import curious
import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")
from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.vector import AutoresetMode  # noqa: E402

NAME = "curious/Drive-v0"
SMALL = {"max_steps": 25}


def action(environment: int, step: int) -> np.ndarray:
    return np.array([np.cos(environment + 0.1 * step), np.sin(environment * 1.7 + 0.3 * step)], np.float32)


def test_check_env_has_no_warning():
    # Warnings are errors in this suite.
    env = gymnasium.make(NAME, render_mode="rgb_array", **SMALL)
    check_env(env.unwrapped)
    env.close()


def test_a_vector_environment_has_the_bits_of_single_ones():
    count, steps = 5, 70
    vector = gymnasium.make_vec(NAME, num_envs=count, vectorization_mode="vector_entry_point", **SMALL)
    assert vector.metadata["autoreset_mode"] == AutoresetMode.SAME_STEP
    alone = type(vector.unwrapped)(num_envs=count, threads=1, **SMALL)
    single = gymnasium.make(NAME, **SMALL)
    rows, info = vector.reset(seed=40)
    rows_alone, _ = alone.reset(seed=40)
    np.testing.assert_array_equal(rows, rows_alone)
    recorded, ends = [], 0
    seeds = [int(info["world_seed"][2])]
    for step in range(steps):
        actions = np.stack([action(index, step) for index in range(count)])
        rows, rewards, terminated, truncated, info = vector.step(actions)
        rows_alone, rewards_alone, *_ = alone.step(actions)
        np.testing.assert_array_equal(rows, rows_alone)
        np.testing.assert_array_equal(rewards, rewards_alone)
        ended = bool(terminated[2] or truncated[2])
        last = info["final_obs"][2] if ended else rows[2]
        recorded.append((last, rewards[2], terminated[2], truncated[2]))
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
        observation, reward, terminated, truncated, info = single.step(action(2, step))
        expected = recorded[step]
        np.testing.assert_array_equal(observation, expected[0])
        assert (np.float32(reward), terminated, truncated) == (np.float32(expected[1]), expected[2], expected[3])
        if terminated or truncated:
            episode += 1
            observation, info = single.reset()
    # A world can be repeated by its seed alone.
    again, _ = single.reset(options={"world_seed": seeds[0]})
    first, _ = single.reset(seed=42)
    np.testing.assert_array_equal(again, first)


def test_snapshots_and_pictures():
    env = gymnasium.make(NAME, render_mode="rgb_array", **SMALL).unwrapped
    world_seed = env.reset(seed=1)[1]["world_seed"]
    for step in range(5):
        env.step(action(0, step))
    snapshot, picture = env.snapshot(), env.render()
    assert picture.dtype == np.uint8 and picture.shape[2] == 3 and max(picture.shape) == 480
    expected = [env.step(action(0, step))[0] for step in range(5, 10)]
    assert not np.array_equal(env.render(), picture)
    env.reset(seed=2)
    env.restore(snapshot)
    np.testing.assert_array_equal(env.render(), picture)
    for step in range(5, 10):
        observation, _, _, _, info = env.step(action(0, step))
        np.testing.assert_array_equal(observation, expected[step - 5])
        assert info["world_seed"] == world_seed
    many = gymnasium.make_vec(NAME, num_envs=2, **SMALL).unwrapped
    many.reset(seed=5)
    many.restore(1, snapshot)
    info = many.step(np.stack([action(0, 5)] * 2))[4]
    # Where the step ends the episode, the seed in `info` is that of the next one.
    seeds = info.get("final_info", info)["world_seed"]
    assert seeds[1] == world_seed != seeds[0]
    with pytest.raises(curious.SnapshotError):
        env.restore(snapshot[:-3])


def test_invalid_actions_are_refused():
    env = gymnasium.make(NAME, **SMALL).unwrapped
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
    vector = gymnasium.make_vec(NAME, num_envs=2, vectorization_mode="vector_entry_point", **SMALL)
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


def test_worlds_are_repeated_by_their_seeds():
    vector = gymnasium.make_vec(NAME, num_envs=2, vectorization_mode="vector_entry_point", **SMALL)

    def run(**keywords) -> tuple[np.ndarray, np.ndarray]:
        observation, info = vector.reset(**keywords)
        rows = [observation]
        for step in range(15):
            rows.append(vector.step(np.stack([action(0, step), action(1, step)]))[0])
        return info["world_seed"], np.concatenate(rows)

    seeds, first = run(seed=7)
    others, _ = run()
    assert (seeds != others).all()
    repeated, again = run(options={"world_seed": seeds})
    np.testing.assert_array_equal(seeds, repeated)
    np.testing.assert_array_equal(first, again)
    env = gymnasium.make(NAME, **SMALL)
    assert env.reset(options={"world_seed": seeds[1]})[1]["world_seed"] == seeds[1]
    for seed, error in ((-1, ValueError), (1 << 64, ValueError), (1.5, TypeError), ("x", TypeError)):
        with pytest.raises(error):
            env.reset(options={"world_seed": seed})


def test_a_deep_copy_goes_on_with_the_same_bits():
    env = gymnasium.make(NAME, **SMALL)
    env.reset(seed=3)
    env.step(action(0, 0))
    other = copy.deepcopy(env)
    for step in range(1, 4):
        one, two = (each.step(action(0, step)) for each in (env, other))
        np.testing.assert_array_equal(one[0], two[0])
        assert one[1] == two[1]
    np.testing.assert_array_equal(env.reset()[0], other.reset()[0])
    for refused in (copy.copy, pickle.dumps):
        with pytest.raises(TypeError, match="cannot be pickled: make another one"):
            refused(env.unwrapped)
    vector = gymnasium.make_vec(NAME, num_envs=2, vectorization_mode="vector_entry_point", **SMALL).unwrapped
    vector.reset(seed=3)
    actions = np.stack([action(0, 0), action(1, 0)])
    vector.step(actions)
    again = copy.deepcopy(vector)
    np.testing.assert_array_equal(vector.step(actions)[0], again.step(actions)[0])


def test_the_values_of_observations_have_names():
    env = gymnasium.make(NAME, **SMALL).unwrapped
    observation, _ = env.reset(seed=1)
    assert env.slices["scan"] == slice(0, 64) and env.slices["velocity"] == slice(69, 71)
    assert sum(observation[of].size for of in env.slices.values()) == observation.size
    for direction in ("goal_direction", "path_direction"):
        assert np.hypot(*observation[env.slices[direction]]) == pytest.approx(1.0, abs=1e-5)


def test_contacts_are_counted():
    env = gymnasium.make(NAME, **SMALL).unwrapped
    _, info = env.reset(seed=1)
    assert info["collisions"] == 0 and isinstance(info["collisions"], int)
    info = env.step(action(0, 0))[4]
    assert info["collisions"] >= 0 and isinstance(info["collisions"], int)
    # A robot that always drives straight on meets a wall, and stays there: one contact, not one per step.
    env = gymnasium.make(NAME, collision_reward=-100.0, max_steps=200).unwrapped
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
    env = gymnasium.make(NAME).unwrapped
    env.reset(seed=1)
    with pytest.warns(UserWarning, match="render.. needs render_mode"):
        assert env.render() is None
    vector = gymnasium.make_vec(NAME, num_envs=2, vectorization_mode="vector_entry_point").unwrapped
    with pytest.warns(UserWarning, match="render.. needs render_mode"):
        assert vector.render() is None


def test_a_window_opens_no_audio_device(monkeypatch):
    pygame = pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    env = gymnasium.make(NAME, render_mode="human").unwrapped
    env.reset(seed=1)
    assert pygame.display.get_init() and pygame.mixer.get_init() is None
    env.close()
    assert not pygame.display.get_init()


def test_settings():
    with pytest.raises(TypeError, match="`threads` is for many environments"):
        gymnasium.make(NAME, threads=2)
    with pytest.raises(TypeError, match="a world is a spec, the name of a shipped world, or a path, and not"):
        gymnasium.make(NAME, world=5)
    with pytest.raises(ValueError, match="render_mode must be one of"):
        curious.envs.DriveVectorEnv(2, render_mode="human")
    with pytest.raises(ValueError, match="unknown field `speed`, expected one of `decision_s`"):
        gymnasium.make(NAME, speed=3)
    with pytest.raises(ValueError, match="goal_radius_m"):
        gymnasium.make(NAME, goal_radius=-1.0)
    with pytest.raises(ValueError, match="the setting `max_steps` cannot be -5"):
        gymnasium.make(NAME, max_steps=-5)
    with pytest.raises(ValueError, match="the setting `goal_radius` cannot be .wide"):
        gymnasium.make(NAME, goal_radius="wide")
    with pytest.raises(FileNotFoundError, match="there is no world `hut`"):
        gymnasium.make(NAME, world="hut")
    with pytest.raises(ValueError, match="number of environments"):
        curious.Batch.drive(curious.Spec.driving_hall(), 0)
    env = gymnasium.make(NAME, world="house", decision_s=0.2, min_goal=4.0)
    observation, info = env.reset(seed=1)
    assert observation.shape == (727,) and info["distance_m"] >= 4.0


def test_the_path_leads_to_the_goal():
    env = gymnasium.make_vec(NAME, num_envs=64, vectorization_mode="vector_entry_point")
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


def test_stable_baselines3(tmp_path):
    pytest.importorskip("stable_baselines3")
    from curious.envs import DriveVectorEnv
    from curious.sb3 import SB3VecEnv
    from stable_baselines3 import PPO
    from stable_baselines3.common.evaluation import evaluate_policy

    env = SB3VecEnv(DriveVectorEnv(num_envs=4, max_steps=20))
    env.seed(3)
    first = env.reset()
    for _ in range(20):
        observations, rewards, dones, infos = env.step(np.zeros((4, 2), np.float32))
    assert rewards.shape == (4,) and dones.all() and all(info["TimeLimit.truncated"] for info in infos)
    assert infos[0]["episode"]["l"] == 20
    # The last observation of an episode, and the first one of the next.
    assert not np.array_equal(infos[0]["terminal_observation"], observations[0])
    # The same seed is the same start.
    env.seed(3)
    np.testing.assert_array_equal(env.reset(), first)
    model = PPO("MlpPolicy", env, n_steps=16, batch_size=64, n_epochs=1, device="cpu", seed=0)
    model.learn(128)
    model.save(tmp_path / "model")
    again = PPO.load(tmp_path / "model", env=env, device="cpu")
    action, _ = again.predict(env.reset(), deterministic=True)
    assert action.shape == (4, 2) and np.abs(action).max() <= 1.0
    returns, lengths = evaluate_policy(again, env, n_eval_episodes=4, return_episode_rewards=True)
    assert lengths == [20] * 4 and np.isfinite(returns).all()


#: The number of `golden_hash` in `environments/tests/tasks.rs`.
GOLDEN = 3425119552214407938


@pytest.mark.parametrize("threads", [1, 3])
def test_python_and_rust_give_the_same_bits(threads):
    batch = curious.Batch.drive(curious.Spec.driving_hall(), 3, threads, max_steps=40)
    count, value = batch.environments, 0xCBF29CE484222325
    batch.reset(np.arange(count, dtype=np.uint64))
    for step in range(60):
        actions = np.float32((np.arange(2 * count) * 7 + step * 3) % 17) / np.float32(8.0) - np.float32(1.0)
        seeds = np.arange(100 + step, 100 + step + count, dtype=np.uint64)
        observations, rewards, *_ = batch.step(actions.reshape(count, 2), seeds)
        for bits in np.concatenate([observations.ravel(), rewards]).view(np.uint32).tolist():
            value = ((value ^ bits) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    assert value == GOLDEN


def test_drive_has_a_memory_with_names():
    env = gymnasium.make(NAME, shows_path=False, shows_memory=True).unwrapped
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
