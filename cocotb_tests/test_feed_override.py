"""Bench of rtl/feed_override.v: every distance equals the twin's, whatever the override does."""

from itertools import chain, repeat

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ClockCycles, RisingEdge
from cocotb.utils import get_sim_time

from cocotb_tests.bench import CLOCK_NS, SEED, WATCHDOG, drive, met, reset, simulate
from nurbs_lab.hardware.feed_override import FeedOverride, OverrideLimits

#: Most cycles from sampling the rate to the distance.
LONGEST = 1215


@pytest.mark.parametrize("word", [21, 35])
def test_feed_override(word):
    simulate("feed_override", __file__, WORD=word)


class Feed:
    """Both sides of the module: offers the periods of a feed, takes distances, each with pauses."""

    def __init__(self, dut, rng):
        self.dut, self.rng = dut, rng
        dut.take.value = dut.in_valid.value = dut.load.value = dut.start.value = dut.stopping.value = 0
        dut.rate.value, dut.may.value = 256, 1

    async def begin(self, moves, limits):
        dut = self.dut
        self.moves, self.number = moves, 0
        dut.load.value = 1
        for index, value in ((5, limits.alpha), (7, limits.beta), (14, limits.prior), (6, 99)):
            dut.load_index.value = index
            drive(dut.load_data, value)
            await RisingEdge(dut.clk)
        dut.load.value, dut.start.value = 0, 1
        await RisingEdge(dut.clk)
        dut.start.value = 0

    async def offer(self):
        dut = self.dut
        for number, move in enumerate(self.moves):
            dut.in_valid.value = 0
            await ClockCycles(dut.clk, 1 + 40 * (self.rng.random() < 0.3))
            dut.in_valid.value = 1
            drive(dut.in_distance, move)
            dut.in_last.value = int(number == len(self.moves) - 1)
            await met(dut, dut.in_take)
        dut.in_valid.value = 0

    async def command(self, script, rates):
        dut = self.dut
        while True:
            wanted = script(len(rates))
            dut.rate.value, dut.stopping.value = max(wanted, 0), int(wanted < 0)
            await met(dut, dut.sampled)
            self.began = get_sim_time("ns")
            rates.append(wanted)

    async def run(self, script):
        """Commands sampled, and distances taken, until the last or until the path is cut."""
        dut, rates, found, ended = self.dut, [], [], False
        others = [cocotb.start_soon(self.offer()), cocotb.start_soon(self.command(script, rates))]
        while not ended:
            await met(dut, dut.valid)
            assert get_sim_time("ns") - self.began <= LONGEST * CLOCK_NS
            if self.rng.random() < 0.3:
                await ClockCycles(dut.clk, int(self.rng.integers(1, 60)))
            dut.take.value = 1
            await RisingEdge(dut.clk)
            found.append(dut.distance.value.to_unsigned())
            ended = dut.is_last.value == 1 or dut.cut.value == 1
            dut.take.value = 0
        for other in others:
            other.cancel()
        return rates, found


def feeds(rng, width):
    """Distances of a few periods and their limits: from rest with jerk, without, of hard jumps, none."""
    top = 1 << width - 3
    ramp = np.append(np.arange(1, 8) / 8, np.ones(6))
    even = [int(top * x) for x in [*ramp, *ramp[::-1]]]
    most = (1 << width) - 1  # as `override_limits` loads it
    yield even, OverrideLimits(top // 6, top // 25, -even[0], 0)
    yield even[2:], OverrideLimits(top // 8, most, even[1], 0)
    yield rng.integers(0, top, 20).tolist(), OverrideLimits(top // 3, top // 40, 0, 0)
    yield [0, 0, *even[:5], 0, 5], OverrideLimits(most, most, 0, 0)


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    rng, width = np.random.default_rng(SEED), len(dut.distance)
    feed, word = Feed(dut, rng), dut.WORD.value.to_unsigned()
    await reset(dut)
    for moves, limits in feeds(rng, width):
        for changes in (0, 4, 12):
            script = np.repeat(rng.choice([0, 0, 256, 400, 30, 200], changes), rng.integers(1, 6, changes))
            await feed.begin(moves, limits)
            rates, found = await feed.run(lambda n, script=script: int([*script, 256][min(n, len(script))]))
            assert found == list(FeedOverride(moves, limits, word).run(rates))
            assert sum(found) == sum(moves)


@cocotb.test(**WATCHDOG)
async def an_abort_cuts_the_path_where_it_rests(dut):
    rng, width = np.random.default_rng(SEED), len(dut.distance)
    feed, word = Feed(dut, rng), dut.WORD.value.to_unsigned()
    await reset(dut)
    for moves, limits in feeds(rng, width):
        for abort in (0, 3, 12, 14):
            held = 3 if abort == 12 else 99  # one comes to rest before
            await feed.begin(moves, limits)
            script = [256] * held + [0] * (99 - held)
            rates, found = await feed.run(lambda n, a=abort, script=script: -1 if n >= a else script[n])
            twin = FeedOverride(moves, limits, word)
            commands = chain((rate if rate >= 0 else None for rate in rates), repeat(None))
            assert found == list(twin.run(commands))
            assert twin.arrived or found[-1] == 0
