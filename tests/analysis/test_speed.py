"""Times that are promised, on a quiet machine:  pytest -m campaign -s tests/analysis/test_speed.py"""

from __future__ import annotations

import time

import pytest

import dualpin as dp

pytestmark = pytest.mark.campaign


def seconds(f, *args, **options):
    started = time.perf_counter()
    result = f(*args, **options)
    return result, time.perf_counter() - started


@pytest.mark.parametrize("floating", [False, True])
def test_base_parameters_of_talos_take_less_than_five_seconds(floating):
    robot = dp.load("talos", floating=floating)
    base, took = seconds(dp.base_parameters, robot)
    print(f"\ntalos{' floating' if floating else ''}: {len(base)} base parameters in {took:.2f} s")
    assert took < 5


def test_ten_million_configurations_take_seconds_on_one_core():
    robot = dp.load("ur5")
    threads = dp.get_num_threads()
    dp.set_num_threads(1)
    try:
        dp.reach_map(robot, "tool0", n=50_000)  # the kernel is compiled
        reach, took = seconds(dp.reach_map, robot, "tool0", n=10_000_000)
    finally:
        dp.set_num_threads(threads)
    print(f"\nur5: {reach.samples} configurations in {took:.2f} s, one core, {reach}")
    assert took < 10
