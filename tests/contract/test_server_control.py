"""Who drives, and what happens when the driver lets go."""

import asyncio

import pytest
from server_clients import RpcError, client, run, running, running_beside


@pytest.fixture(scope="module")
def server():
    """A server for tests that leave it as they find it."""
    with running_beside() as server:
        yield server


async def rate_of(each):
    return (await each.call("variables.read", names=["winch.rate"]))["values"][0]


async def eventually(each, rate, within):
    """Wait until the winch turns at this rate, and say how long it took [s]."""
    begin = asyncio.get_running_loop().time()
    while await rate_of(each) != rate:
        assert asyncio.get_running_loop().time() - begin < within, f"the rate is not {rate} within {within} s"
        await asyncio.sleep(0.01)
    return asyncio.get_running_loop().time() - begin


def test_a_driver_drives():
    async def scenario():
        async with running() as server, client(server) as driver:
            acquired = await driver.call("control.acquire")
            assert acquired == {"driver": (await driver.call("simulation.status"))["you"], "lease": 5.0}
            assert await driver.call("control.command", axes={"hoist": 0.5}, deadman=True) == {"accepted": True}
            await eventually(driver, 0.5, within=0.3)
            await driver.call("control.command", axes={}, deadman=True)
            await eventually(driver, 0.0, within=0.3)

    run(scenario())


def test_a_command_that_is_not_renewed_lapses_within_half_a_second():
    async def scenario():
        async with running() as server, client(server) as driver:
            await driver.call("control.acquire")
            await driver.call("control.command", axes={"hoist": 0.5}, deadman=True)
            await eventually(driver, 0.5, within=0.3)
            held = await eventually(driver, 0.0, within=0.7)
            assert held > 0.3, "not before its time"

    run(scenario())


def test_a_command_that_is_renewed_holds():
    async def scenario():
        async with running() as server, client(server) as driver:
            await driver.call("control.acquire")
            for _ in range(12):
                await driver.call("control.command", axes={"hoist": 0.5}, deadman=True)
                await asyncio.sleep(0.1)
            assert await rate_of(driver) == 0.5

    run(scenario())


def test_a_lost_link_stops_all_axes_and_gives_the_stick_back():
    async def scenario():
        async with running() as server, client(server) as viewer:
            async with client(server) as driver:
                await driver.call("control.acquire")
                await driver.call("control.command", axes={"hoist": 0.5}, deadman=True)
                await eventually(viewer, 0.5, within=0.3)
                driver.connection.transport.abort()
                took = await eventually(viewer, 0.0, within=0.45)
                assert took < 0.4, "before the command lapses by itself"
            assert (await viewer.call("simulation.status"))["driver"] is None

    run(scenario())


def test_a_viewer_cannot_drive():
    async def scenario():
        async with running() as server, client(server) as driver, client(server) as viewer:
            with pytest.raises(RpcError, match=r"nobody is driving, not you .* Call control.acquire first"):
                await viewer.call("control.command", axes={"hoist": 1.0}, deadman=True)
            number = (await driver.call("control.acquire"))["driver"]
            with pytest.raises(RpcError, match=rf"client {number} is driving, not you"):
                await viewer.call("control.command", axes={"hoist": 1.0}, deadman=True)
            assert await rate_of(viewer) == 0.0

    run(scenario())


def test_the_stick_is_taken_over_only_openly_and_at_rest():
    async def scenario():
        async with running() as server, client(server) as first, client(server) as second:
            await first.call("control.acquire")
            await first.call("control.command", axes={"hoist": 0.5}, deadman=True)
            with pytest.raises(RpcError, match="with take_over true"):
                await second.call("control.acquire")
            taken = await second.call("control.acquire", take_over=True)
            assert (await first.call("simulation.status"))["driver"] == taken["driver"]
            await eventually(first, 0.0, within=0.3)
            with pytest.raises(RpcError):
                await first.call("control.command", axes={"hoist": 0.5}, deadman=True)

    run(scenario())


def test_a_silent_driver_loses_the_stick_after_five_seconds():
    async def scenario():
        async with running() as server, client(server) as driver:
            await driver.call("control.acquire")
            await asyncio.sleep(4.5)
            assert (await driver.call("simulation.status"))["driver"] is not None
            await asyncio.sleep(0.8)
            assert (await driver.call("simulation.status"))["driver"] is None

    run(scenario())


def test_release_stops_all_axes():
    async def scenario():
        async with running() as server, client(server) as driver:
            await driver.call("control.acquire")
            await driver.call("control.command", axes={"hoist": 0.5}, deadman=True)
            await eventually(driver, 0.5, within=0.3)
            assert await driver.call("control.release") == {"released": True}
            await eventually(driver, 0.0, within=0.3)
            assert await driver.call("control.release") == {"released": False}

    run(scenario())


@pytest.mark.parametrize(
    ("axes", "message"),
    [
        ({"host": 0.5}, r"axes\.host: no such axis\. Did you mean 'hoist'\?"),
        ({"hoist": 1.5}, r"axes.*<= 1\.0"),
        ({"hoist": "0.5"}, r"Expected `float`, got `str`"),
        ({"hoist": True}, r"Expected `float`, got `bool`"),
    ],
)
def test_a_command_that_makes_no_sense_is_refused(server, axes, message):
    async def scenario():
        async with client(server) as driver:
            await driver.call("control.acquire", take_over=True)
            with pytest.raises(RpcError, match=message):
                await driver.call("control.command", axes=axes, deadman=True)

    run(scenario())
