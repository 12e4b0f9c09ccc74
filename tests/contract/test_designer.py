"""The designer's server over HTTP: what the page and programs get, and what strangers do not."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx
import msgspec
import pytest

from seacrane import design, studies
from seacrane.design import archive, mass, mesh
from seacrane.design.parts import Box, Imported
from seacrane.errors import ServerError
from seacrane.operation import demo
from seacrane.server import Desk


@asynccontextmanager
async def desk(tmp_path: Path, opened: design.Crane | None = None) -> AsyncIterator[httpx.AsyncClient]:
    """A client that has opened the address which a running desk prints."""
    page = tmp_path / "page"
    page.mkdir(exist_ok=True)
    (page / "designer.html").write_text("<!doctype html><title>designer</title>")
    running = Desk(demo.FACTORY, opened=opened, port=0, page=page)
    await running.start()
    try:
        address = running.address_with_token
        async with httpx.AsyncClient(
            base_url=address.split("?")[0], follow_redirects=True, timeout=120, trust_env=False
        ) as client:
            assert "designer" in (await client.get(address)).text
            yield client
    finally:
        await running.stop()


def test_shipped_designs_are_listed_and_given_in_si(tmp_path: Path) -> None:
    async def scenario() -> None:
        async with desk(tmp_path) as client:
            listed = (await client.get("api/designs")).json()["designs"]
            assert [item["name"] for item in listed] == design.names()
            text = (await client.get("api/designs/gunnerus-pk65")).text
            assert design.loads(text) == design.load("gunnerus-pk65")
            assert (await client.get("api/designs/none")).status_code == 404
            assert (await client.get("api/design/opened")).status_code == 204

    asyncio.run(scenario())


def test_the_design_of_the_command_is_the_one_opened(tmp_path: Path) -> None:
    async def scenario() -> None:
        crane = design.load("a-frame-30t")
        async with desk(tmp_path, crane) as client:
            assert design.loads((await client.get("api/design/opened")).text) == crane

    asyncio.run(scenario())


def test_all_problems_of_a_design_are_told_at_once(tmp_path: Path) -> None:
    async def scenario() -> None:
        data = json.loads(design.to_json(design.load("offshore-100t")))
        async with desk(tmp_path) as client:
            assert (await client.post("api/design/check", json=data)).json() == {"problems": []}
            data["cylinders"][0]["stroke"] = 4.0
            data["cylinders"][1]["rod"] = 0.5
            told = (await client.post("api/design/check", json=data)).json()["problems"]
            assert {p["path"] for p in told} == {
                "design: cylinders[boom_cylinder].stroke",
                "design: cylinders[jib_cylinder].rod",
            }
            refused = await client.post("api/design/export", json=data)
            assert refused.status_code == 422
            assert refused.json()["problems"] == told
            refused = await client.post("api/design/check", content=b"{")
            assert "is not JSON" in refused.json()["problems"][0]["message"]

    asyncio.run(scenario())


def test_an_exported_archive_imports_equal_and_others_are_refused_with_the_reason(tmp_path: Path) -> None:
    async def scenario() -> None:
        crane = design.load("a-frame-30t")
        async with desk(tmp_path) as client:
            packed = await client.post("api/design/export", content=design.to_json(crane))
            assert packed.headers["content-type"] == "application/zip"
            assert 'filename="a-frame-30t.zip"' in packed.headers["content-disposition"]
            assert archive.unpacked(packed.content, "zip") == crane
            back = await client.post("api/design/import", content=packed.content)
            assert design.loads(back.text) == crane
            cut = await client.post("api/design/import", content=packed.content[:1000])
            assert cut.status_code == 422
            assert "is not a whole ZIP archive" in cut.json()["problems"][0]["message"]

    asyncio.run(scenario())


def test_a_request_that_is_too_large_is_refused(tmp_path: Path) -> None:
    async def scenario() -> None:
        async with desk(tmp_path) as client:
            answer = await client.post("api/design/check", content=b" " * (17 * 2**20))
            assert answer.status_code == 422
            assert "is larger than 16 MiB" in answer.json()["problems"][0]["message"]

    asyncio.run(scenario())


def test_strangers_get_nothing(tmp_path: Path) -> None:
    async def scenario() -> None:
        async with desk(tmp_path) as client:
            async with httpx.AsyncClient(base_url=client.base_url, trust_env=False) as stranger:
                for path in ("", "designer.html", "api/designs", "api/design/opened"):
                    assert (await stranger.get(path)).status_code == 401
                assert (await stranger.post("api/design/simulate", json={})).status_code == 401
            forged = await client.get("api/designs", headers={"Origin": "http://crane.example"})
            assert forged.status_code == 403

    asyncio.run(scenario())


def test_a_crane_that_cannot_be_operated_or_a_posture_it_cannot_take_is_refused_in_words(tmp_path: Path) -> None:
    async def scenario() -> None:
        offshore, frame = (json.loads(design.to_json(design.load(n))) for n in ("offshore-100t", "a-frame-30t"))
        loose = frame | {"cylinders": [c for c in frame["cylinders"] if c["moves"] != "luff"]}
        async with desk(tmp_path) as client:
            for asked, words in (
                ({"design": loose}, "joint luff"),
                ({"design": loose}, "turns and nothing moves it"),
                ({"design": offshore, "posture": {"luff": 2.0, "jib": -1.0}}, "114.6 deg is beyond its limits"),
                ({"design": offshore, "posture": {"luf": 0.5}}, "is not a joint of the crane"),
                ({"design": offshore, "posture": {"luff": "up"}}, "must be numbers"),
                ({"design": offshore, "load": 1e9}, "load"),
                ({"design": offshore, "hs": 40}, "40 m is out of range"),
                ({"design": offshore, "hs": "calm"}, "must be numbers"),
                ({"design": 3}, "does not hold a crane"),
                ([], "must be a JSON object"),
            ):
                answer = await client.post("api/design/simulate", json=asked)
                assert answer.status_code == 422, answer.text
                assert words in answer.text

    asyncio.run(scenario())


def test_a_design_is_operated_in_the_posture_and_with_the_load_asked_for(tmp_path: Path) -> None:
    async def scenario() -> None:
        crane = json.loads(design.to_json(design.load("offshore-100t")))
        asked = {"design": crane, "posture": {"slew": 1.5707963267948966, "luff": 0.8726646259971648, "jib": -1.2217}}
        async with desk(tmp_path) as client:
            answer = await client.post("api/design/simulate", json={**asked, "load": 40e3})
            assert answer.status_code == 200, answer.text
            address = urlsplit(answer.json()["address"])
            token = address.query.removeprefix("token=")
            async with httpx.AsyncClient(trust_env=False) as operator:
                reply = await operator.get(
                    f"http://{address.netloc}/api/openrpc.json", headers={"Authorization": f"Bearer {token}"}
                )
            assert reply.json()["info"]["title"] == "seacrane"

    asyncio.run(scenario())


def test_a_desk_for_other_machines_must_be_allowed() -> None:
    with pytest.raises(ServerError, match="can be reached from other machines"):
        Desk(demo.FACTORY, host="0.0.0.0", port=0)


def test_a_search_for_better_designs_tells_its_front_as_it_grows(tmp_path: Path) -> None:
    async def scenario() -> None:
        asked = {
            "design": json.loads(design.to_json(design.load("offshore-100t"))),
            "variables": [{"path": "links[jib].length"}, {"path": "cylinders[jib_cylinder].bore"}],
            "goals": [{"kind": "reach"}, {"kind": "capacity", "radius": 20}],
            "generations": 3,
            "population": 8,
        }
        async with desk(tmp_path) as client:
            nothing = (await client.get("api/design/optimise")).json()
            assert nothing == {
                "running": False,
                "generations": 0,
                "front": None,
                "stands": None,
                "hindered": [],
                "problems": [],
            }
            begun = (await client.post("api/design/optimise", json=asked)).json()
            assert begun["front"]["generation"] == 0
            assert begun["stands"] == pytest.approx(begun["front"]["results"][0])
            told = await ended(client)
            assert told["front"]["generation"] == 3
            assert any(told["front"]["best"])
            assert told["stands"] == begun["stands"]
            await client.post("api/design/optimise", json={**asked, "generations": 500})
            stopped = (await client.post("api/design/optimise/stop")).json()
            assert stopped["running"] is False
            refused = await client.post("api/design/optimise", json={**asked, "goals": []})
            assert refused.status_code == 422
            assert "two goals or more" in refused.text
            wide = {**asked, "variables": [{"path": "cylinders[jib_cylinder].bore", "low": 5, "high": 6}]}
            begun = (await client.post("api/design/optimise", json={**wide, "generations": 1})).json()
            assert "a stroke and a bore take" in begun["hindered"][0]
            assert (await client.get("api/design/optimise")).json()["front"] is not None

    asyncio.run(scenario())


def test_a_search_goes_on_as_if_it_had_not_ended(tmp_path: Path) -> None:
    async def scenario() -> None:
        asked = {
            "design": json.loads(design.to_json(design.load("offshore-100t"))),
            "variables": [{"path": "links[jib].length"}],
            "goals": [{"kind": "reach"}, {"kind": "weight"}],
            "population": 4,
        }
        async with desk(tmp_path) as client:
            refused = await client.post("api/design/optimise/resume", json={"generations": 3})
            assert (refused.status_code, "no search" in refused.text) == (422, True)
            await client.post("api/design/optimise", json={**asked, "generations": 3})
            whole = await ended(client)
            await client.post("api/design/optimise", json={**asked, "generations": 1})
            await ended(client)
            refused = await client.post("api/design/optimise/resume", json={"generations": 1})
            assert (refused.status_code, "2 to 1000" in refused.text) == (422, True)
            resumed = await client.post("api/design/optimise/resume", json={"generations": 3})
            assert resumed.json()["front"]["generation"] == 1
            assert await ended(client) == whole

    asyncio.run(scenario())


def test_a_saved_front_is_opened_and_gone_on_from_and_a_damaged_one_is_refused(tmp_path: Path) -> None:
    async def scenario() -> None:
        crane = design.load("offshore-100t")
        variables = [studies.Variable("links[jib].length", 10, 18)]
        first, _, third = studies.optimise(
            crane, variables, [studies.Goal("reach"), studies.Goal("weight")], population=8, generations=2
        )
        studies.save(first, tmp_path / "front.json")
        async with desk(tmp_path) as client:
            opened = await client.post("api/design/optimise/open", content=(tmp_path / "front.json").read_bytes())
            assert opened.json()["front"] == studies.plain(first)
            assert len(opened.json()["stands"]) == 2
            await client.post("api/design/optimise/resume", json={"generations": 2})
            assert (await ended(client))["front"] == studies.plain(third)
            refused = await client.post("api/design/optimise/open", content=b'{"format": "seacrane-crane/1"}')
            assert refused.status_code == 422
            assert "is not a saved optimisation" in refused.text
            assert (await client.get("api/design/optimise")).json()["front"] == studies.plain(third)

    asyncio.run(scenario())


async def ended(client: httpx.AsyncClient) -> dict[str, Any]:
    """What is told of a search once it runs no more."""
    for _ in range(300):
        told: dict[str, Any] = (await client.get("api/design/optimise")).json()
        if not told["running"]:
            return told
        await asyncio.sleep(0.1)
    pytest.fail("the search does not end")


def test_a_design_is_given_with_other_sizes(tmp_path: Path) -> None:
    async def scenario() -> None:
        crane = design.load("offshore-100t")
        data = json.loads(design.to_json(crane))
        sizes = {"links[jib].length": 12.5, "cylinders[jib_cylinder].bore": 0.4}
        async with desk(tmp_path) as client:
            answer = await client.post("api/design/change", json={"design": data, "changes": sizes})
            assert design.loads(answer.text) == design.changes.changed(crane, sizes)
            for wrong, words in (
                ({"links[jip].length": 12}, "no such link"),
                ({"links[jib].length": -1}, "length"),
                ({"links[jib].length": "long"}, "must be numbers in m"),
                (["links[jib].length"], "must be numbers in m"),
            ):
                refused = await client.post("api/design/change", json={"design": data, "changes": wrong})
                assert (refused.status_code, words in refused.text) == (422, True), refused.text

    asyncio.run(scenario())


def test_a_mesh_of_another_program_becomes_a_part(tmp_path: Path) -> None:
    async def scenario() -> None:
        house = mesh.mesh(Box(name="house", centre=(0, 0, 0), size=(1, 2, 3)))
        stl = archive.stereolithography(mesh.Mesh(house.vertices * 1000, house.faces))
        async with desk(tmp_path) as client:
            answer = await client.post("api/design/mesh?name=house.stl&unit=mm", content=stl)
            assert answer.json()["kind"] == "mesh"
            part = msgspec.convert(answer.json(), type=Imported)
            assert mass.of_part(part).mass == pytest.approx(6 * 7850, rel=1e-6)
            refused = await client.post("api/design/mesh?name=house.step", content=stl)
            assert refused.status_code == 422
            assert "allowed: .stl" in refused.text or ".stl" in refused.json()["problems"][0]["allowed"]

    asyncio.run(scenario())
