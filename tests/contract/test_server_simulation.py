"""What clients see of a running simulation, over a real socket from a real process."""

import asyncio
import json
import os
import signal
import socket

import pytest
from server_clients import RpcError, client, get_with_token, run, running, running_beside

from seacrane.results import Recording


@pytest.fixture(scope="module")
def server():
    """A server for tests that leave it as they find it."""
    with running_beside() as server:
        yield server


def test_two_clients_see_the_same_values_at_the_same_simulated_time(server):
    async def scenario():
        async with client(server) as one, client(server) as two:
            await one.call("stream.subscribe", variables=["pendulum.swing", "winch.angle"], rate=60)
            await two.call("stream.subscribe", variables=["pendulum.swing", "winch.angle"], rate=20)
            await one.until(lambda: len(one.frames) > 60)
            seen = {frame["time"]: frame["values"] for frame in one.frames}
            common = [frame for frame in two.frames if frame["time"] in seen]
            assert len(common) >= 10
            assert all(frame["values"] == seen[frame["time"]] for frame in common)

    run(scenario())


def test_simulated_time_keeps_pace_with_the_wall_clock(server):
    async def scenario():
        async with client(server) as each:
            await each.call("stream.subscribe", variables=["pendulum.swing"], rate=60)
            await each.until(lambda: len(each.frames) > 120)
            simulated = each.frames[-1]["time"] - each.frames[10]["time"]
            assert simulated == pytest.approx(each.times[-1] - each.times[10], abs=0.1)

    run(scenario())


@pytest.mark.parametrize("rate", [10.0, 24.0])
def test_a_subscription_comes_at_its_rate(server, rate):
    async def scenario():
        async with client(server) as each:
            answer = await each.call("stream.subscribe", variables=["pendulum.swing"], rate=rate)
            assert answer["rate"] == rate
            await each.until(lambda: len(each.frames) > 2 * rate)
            span = each.frames[-1]["time"] - each.frames[1]["time"]
            assert (len(each.frames) - 2) / span == pytest.approx(rate, rel=0.1)

    run(scenario())


def test_a_rate_above_that_of_the_simulation_is_answered_with_what_it_is(server):
    async def scenario():
        async with client(server) as each:
            answer = await each.call("stream.subscribe", variables=["pendulum.swing"], rate=500)
            assert answer["rate"] == pytest.approx(60)

    run(scenario())


def test_a_client_that_acknowledges_nothing_gets_four_frames(server):
    async def scenario():
        async with client(server, acknowledges=False) as each:
            answer = await each.call("stream.subscribe", variables=["pendulum.swing"], rate=60)
            await asyncio.sleep(0.5)
            assert len(each.frames) == 4
            await each.call("stream.ack", subscription=answer["subscription"], seq=each.frames[1]["seq"])
            await asyncio.sleep(0.3)
            assert len(each.frames) == 6
            assert each.frames[4]["time"] > each.frames[3]["time"] + 0.3, "the latest frame, not a queued one"

    run(scenario())


def test_a_client_that_acknowledges_nothing_is_cut_off_after_five_seconds(server):
    async def scenario():
        async with client(server, acknowledges=False) as each:
            await each.call("stream.subscribe", variables=["pendulum.swing"], rate=60)
            await asyncio.wait_for(each.connection.wait_closed(), 8)

    run(scenario())


def test_a_client_that_stops_reading_slows_nobody_and_is_cut_off():
    async def scenario():
        names = [f"pendulum.extra{index}" for index in range(500)]
        async with running(extra=500) as server, client(server) as lively:
            silent = socket.socket()
            silent.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8192)
            silent.connect(("127.0.0.1", server.tcp_port))
            calls = [
                {"method": "authenticate", "params": {"token": server.token}},
                {"method": "stream.subscribe", "params": {"variables": names, "rate": 60}},
            ]
            # Acknowledged in advance, so that only its silent socket holds it back.
            calls += [{"method": "stream.ack", "params": {"subscription": 1, "seq": 10**9}}]
            with silent:
                for number, call in enumerate(calls):
                    silent.sendall(json.dumps({"jsonrpc": "2.0", "id": number, **call}).encode() + b"\n")
                await lively.call("stream.subscribe", variables=names, rate=60)
                assert (await lively.call("simulation.status"))["clients"] == 2
                await lively.until(lambda: len(lively.frames) > 400, timeout=15)
                span = lively.times[-1] - lively.times[10]
                assert (len(lively.times) - 11) / span > 55
                assert (await lively.call("simulation.status"))["clients"] == 1

    run(scenario())


def test_variables_are_read_by_name_in_the_order_asked_for():
    async def scenario():
        async with running() as server, client(server) as each:
            await each.call("simulation.pause")
            answer = await each.call("variables.read", names=["winch.rate", "pendulum.swing"])
            again = await each.call("variables.read", names=["pendulum.swing", "winch.rate"])
            assert answer["values"] == again["values"][::-1]
            assert answer["time"] == again["time"]

    run(scenario())


def test_an_unknown_variable_is_answered_with_the_nearest(server):
    async def scenario():
        async with client(server) as each:
            with pytest.raises(RpcError, match=r"no variable 'winch.angel'. Did you mean 'winch.angle'") as caught:
                await each.call("variables.read", names=["winch.angel", "pendulum.swing"])
            assert caught.value.code == -32000
            assert caught.value.data["code"] == "server"
            assert caught.value.data["problems"][0]["path"] == "names[0]"

    run(scenario())


def test_paused_time_stands_still_and_is_shown_once():
    async def scenario():
        async with running() as server, client(server) as each:
            status = await each.call("simulation.pause")
            assert status["running"] is False
            await each.call("stream.subscribe", variables=["pendulum.swing"], rate=60)
            await asyncio.sleep(0.3)
            assert [frame["time"] for frame in each.frames] == [status["time"]]
            status = await each.call("simulation.resume")
            assert status["running"] is True
            await each.until(lambda: len(each.frames) > 5)
            assert each.frames[1]["time"] - each.frames[0]["time"] < 0.1, "the pause is not caught up"

    run(scenario())


@pytest.mark.parametrize("saves", [True, False])
def test_reset_starts_again_at_time_zero_with_everything_at_rest(saves):
    async def scenario():
        async with running(saves=saves) as server, client(server) as each:
            await each.call("control.acquire")
            await each.call("control.command", axes={"hoist": 1.0}, deadman=True)
            await asyncio.sleep(0.3)
            moved = await each.call("variables.read", names=["winch.angle"])
            assert moved["values"][0] > 0.1
            status = await each.call("simulation.reset")
            assert status["time"] < 0.2
            assert status["running"]
            after = await each.call("variables.read", names=["winch.angle", "winch.rate"])
            assert after["values"] == [0.0, 0.0]
            answer = await get_with_token(server, "/api/recording.csv?variables=winch.angle")
            assert {line.split(",")[1] for line in answer.text.splitlines()[1:]} == {"0.0"}

    run(scenario())


def test_the_model_is_described_as_the_simulation_describes_itself(server):
    async def scenario():
        async with client(server) as each:
            description = await each.call("model.describe")
            assert description["axes"] == ["hoist", "slew"]
            assert {"name": "winch.angle", "unit": "rad", "shown": "deg"} in description["variables"]

    run(scenario())


def test_the_status_says_how_well_real_time_is_kept():
    async def scenario():
        async with running() as server, client(server) as each:
            await asyncio.sleep(1.0)
            status = await each.call("simulation.status")
            assert status["macro_step"] == 0.002
            assert 0 < status["real_time_factor"] < 1
            assert status["late_ms_p99"] >= 0
            assert status["clients"] == 1
            assert (status["driver"], status["error"], status["finished"]) == (None, None, False)
            assert status["time"] - status["recorded"] < 0.1

    run(scenario())


# ---------------------------------------------------------------- recording
def test_the_recording_holds_what_was_streamed(tmp_path):
    async def scenario():
        async with running() as server, client(server) as each:
            await each.call("control.acquire")
            await each.call("stream.subscribe", variables=["winch.angle", "pendulum.swing"], rate=60)
            await each.call("control.command", axes={"hoist": 0.7}, deadman=True)
            await each.until(lambda: len(each.frames) > 150)
            answer = await get_with_token(server, "/api/recording.csv?variables=winch.angle,pendulum.swing")
            assert answer.headers["content-type"].startswith("text/csv")
            (tmp_path / "recording.csv").write_bytes(answer.content)
            recording = Recording.read_csv(tmp_path / "recording.csv")
            assert list(recording.signals) == ["winch.angle", "pendulum.swing"]
            rows = {
                round(time, 6): [angle, swing]
                for time, angle, swing in zip(
                    recording.time, recording["winch.angle"], recording["pendulum.swing"], strict=True
                )
            }
            common = [frame for frame in each.frames if round(frame["time"], 6) in rows]
            assert len(common) >= 5
            assert all(frame["values"] == rows[round(frame["time"], 6)] for frame in common)

    run(scenario())


def test_the_recording_of_all_variables_has_a_row_each_twenty_milliseconds(tmp_path):
    async def scenario():
        async with running() as server:
            await asyncio.sleep(1.0)
            answer = await get_with_token(server, "/api/recording.csv")
            (tmp_path / "recording.csv").write_bytes(answer.content)
            recording = Recording.read_csv(tmp_path / "recording.csv")
            assert list(recording.signals) == list(server.simulation.names)
            assert recording.time[:3].tolist() == [0.0, 0.02, 0.04]
            assert len(recording.time) > 40

    run(scenario())


def test_the_recording_of_an_unknown_variable_is_refused_with_the_nearest(server):
    async def scenario():
        answer = await get_with_token(server, "/api/recording.csv?variables=winch.angel,pendulum.swing")
        assert answer.status_code == 400
        assert "no variable 'winch.angel'. Did you mean 'winch.angle'" in answer.text

    run(scenario())


def test_a_reset_begins_a_new_recording():
    async def scenario():
        async with running() as server, client(server) as each:
            await asyncio.sleep(0.6)
            status = await each.call("simulation.reset")
            assert status["recorded"] < 0.2
            status = await each.call("simulation.pause")
            answer = await get_with_token(server, "/api/recording.csv?variables=winch.angle")
            lines = answer.text.splitlines()
            assert lines[0] == "time [s],winch.angle [rad]"
            assert lines[1] == "0.0,0.0"
            times = [float(line.split(",")[0]) for line in lines[1:]]
            assert times == pytest.approx([0.02 * row for row in range(len(times))])
            assert times[-1] <= status["time"]

    run(scenario())


# ---------------------------------------------------------------- when it goes wrong
def test_an_error_in_the_simulation_is_shown_and_the_recording_kept():
    async def scenario():
        async with running(fail_at=0.5) as server, client(server) as each:
            await asyncio.sleep(1.0)
            status = await each.call("simulation.status")
            assert status["finished"]
            assert not status["running"]
            assert "the drum has come off" in status["error"]
            assert "winch" in status["error"]
            answer = await get_with_token(server, "/api/recording.csv")
            assert float(answer.text.splitlines()[-1].split(",")[0]) == pytest.approx(0.5, abs=0.021)
            status = await each.call("simulation.reset")
            assert status["error"] is None
            assert status["running"]

    run(scenario())


def test_a_simulation_process_that_is_killed_is_reported_and_can_be_started_again():
    async def scenario():
        async with running() as server, client(server) as each:
            await each.call("stream.subscribe", variables=["pendulum.swing"], rate=60)
            await each.until(lambda: len(each.frames) > 10)
            os.kill(server.simulation.pid, signal.SIGKILL)
            await asyncio.sleep(0.3)
            status = await each.call("simulation.status")
            assert status["error"] == "the simulation process was ended by SIGKILL"
            assert status["finished"]
            with pytest.raises(RpcError, match=r"Call simulation.reset to start it anew"):
                await each.call("simulation.resume")
            seen = len(each.frames)
            status = await each.call("simulation.reset")
            assert (status["error"], status["running"]) == (None, True)
            await each.until(lambda: len(each.frames) > seen + 10)

    run(scenario())
