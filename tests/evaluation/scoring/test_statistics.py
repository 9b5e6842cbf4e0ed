"""Intervals and tests against published values, and against what is known of them."""

import numpy as np
import pytest

from remqa_data.evaluation.scoring.statistics import difference, estimate, estimate_over_runs


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def test_wilson_interval_where_all_or_none_succeed() -> None:
    # Newcombe, Statistics in Medicine 17 (1998), table I: 0/20 and 0/29 by Wilson's score method.
    none = estimate(np.zeros(20, bool), np.arange(20), rng())
    assert (none.low, none.high) == pytest.approx((0.0, 0.1611), abs=5e-5)
    assert estimate(np.zeros(29, bool), np.arange(29), rng()).high == pytest.approx(0.1170, abs=5e-5)
    every = estimate(np.ones(20), np.zeros(20, int), rng())
    assert (every.low, every.high, every.interval) == (pytest.approx(1 - 0.1611, abs=5e-5), 1.0, "wilson")


@pytest.mark.slow
def test_the_interval_covers_the_truth_about_95_times_in_100() -> None:
    draws = np.random.default_rng(1)
    hits = 0
    for _ in range(100):
        chance = draws.beta(8, 8, 20).repeat(30)  # scenes differ, their mean is 0.5
        found = estimate(draws.random(600) < chance, np.arange(20).repeat(30), draws)
        hits += found.low <= 0.5 <= found.high
    assert 85 <= hits <= 100


def test_scenes_that_are_alike_inside_widen_the_interval() -> None:
    values = np.arange(20).repeat(30) % 2 == 0  # each scene all or nothing
    by_scene = estimate(values, np.arange(20).repeat(30), rng())
    by_question = estimate(values, np.arange(600), rng())
    assert by_scene.high - by_scene.low > 3 * (by_question.high - by_question.low)


@pytest.mark.slow
def test_the_interval_over_runs_covers_the_truth_where_runs_and_scenes_differ() -> None:
    draws = np.random.default_rng(3)
    hits = 0
    for _ in range(60):
        of_scene, of_run = draws.normal(0, 0.1, 20), draws.normal(0, 0.05, 10)
        chance = np.clip(0.5 + of_run[:, None] + of_scene.repeat(30), 0, 1)
        found = estimate_over_runs(draws.random((10, 600)) < chance, np.arange(20).repeat(30), draws)
        hits += found.low <= 0.5 <= found.high
    assert 50 <= hits <= 60


def test_runs_that_are_alike_say_what_one_says_and_unlike_ones_less() -> None:
    scenes = np.arange(20).repeat(30)
    one = np.random.default_rng(4).random(600) < 0.5
    same, alone = estimate_over_runs([one, one, one], scenes, rng()), estimate(one, scenes, rng())
    assert same.value == pytest.approx(alone.value)
    assert (same.low, same.high) == pytest.approx((alone.low, alone.high), abs=0.01)
    unlike = estimate_over_runs([one, one | True, one & False], scenes, rng())
    assert unlike.value == pytest.approx((alone.value + 1) / 3)
    assert unlike.high - unlike.low > 4 * (same.high - same.low)


def test_one_scene_has_no_interval() -> None:
    found = estimate(np.array([True, False]), np.zeros(2, int), rng())
    assert (found.low, found.high, found.interval) == (None, None, "none")


def test_scenes_whose_means_differ_by_rounding_alone_have_no_interval() -> None:
    scenes = np.array([0, 1, 1, 1])
    found = estimate(np.array([0.1, 0.1, 0.1, 0.1]), scenes, rng())  # 0.1 + 0.1 + 0.1 is not 3 * 0.1
    assert (found.low, found.high, found.interval) == (None, None, "none")
    change = difference(np.zeros(4), np.full(4, 0.1), scenes, rng())
    assert (change.low, change.high, change.detectable) == (None, None, None)


def test_a_real_difference_is_found_and_none_is_not() -> None:
    draws = np.random.default_rng(2)
    scenes = np.arange(20).repeat(30)
    first, other = draws.random(600) < 0.5, draws.random(600) < 0.5
    better = first | (draws.random(600) < 0.4)
    found = difference(first, better, scenes, rng())
    assert found.low > 0.1
    assert found.p_value < 0.001
    assert found.detectable < found.value
    chance = difference(first, other, scenes, rng())
    assert chance.low < 0 < chance.high
    assert chance.p_value > 0.05
    same = difference(first, first, scenes, rng())
    assert (same.value, same.p_value, same.detectable) == (0.0, 1.0, None)


def test_the_p_value_of_few_scenes_is_the_exact_one() -> None:
    # By hand: all five scenes better, so 2 of the 2^5 sign patterns are as extreme.
    found = difference(np.zeros(5), np.ones(5) * [0.1, 0.2, 0.3, 0.4, 0.5], np.arange(5), rng())
    assert found.p_value == pytest.approx(2 / 32)


def test_the_detectable_difference_is_that_of_the_paired_t_test_where_scenes_are_equal() -> None:
    # Power of the paired t test as in textbooks: (t(0.975, 19) + t(0.8, 19)) * s / sqrt(20), with t from tables.
    changes = np.random.default_rng(3).normal(0.1, 0.3, 20)
    found = difference(np.zeros(600), changes.repeat(30), np.arange(20).repeat(30), rng())
    assert found.detectable == pytest.approx((2.093 + 0.861) * changes.std(ddof=1) / np.sqrt(20), rel=0.03)
