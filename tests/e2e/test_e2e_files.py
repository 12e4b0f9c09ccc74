"""Designs kept, compared, lost and brought in, in a real browser; files from strangers."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import trimesh

from seacrane import design
from seacrane.design import mass
from seacrane.design.parts import STEEL

Browse = Callable[..., Any]


@pytest.mark.parametrize(
    "scenario", ["keeps_versions_and_duplicates", "compares_two_designs", "loses_at_most_two_seconds_in_a_crash"]
)
def test_a_designer(scenario: str, designer: str, browse: Browse) -> None:
    browse("files.mjs", designer, scenario)


def test_files_of_strangers_are_refused_with_the_reason(designer: str, browse: Browse, tmp_path: Path) -> None:
    folder = tmp_path / "hostile"
    folder.mkdir()
    good = design.to_json(design.load("offshore-100t"))

    def packed(name: str, *entries: tuple[str, bytes | str]) -> None:
        with zipfile.ZipFile(folder / name, "w", zipfile.ZIP_DEFLATED) as archive:
            for entry, content in entries:
                archive.writestr(entry, content)

    packed("bomb.zip", ("design.json", b" " * (17 << 20)))
    packed("elsewhere.zip", ("../../design.json", good))
    packed("many.zip", *((f"{i}.json", "{}") for i in range(1100)), ("design.json", good))
    packed("markup.zip", ("design.json", json.dumps({"format": "<img src=x onerror=alert(1)>"})))
    packed("nan.zip", ("design.json", good.replace('"mass": 110000.0', '"mass": NaN')))
    (folder / "torn.zip").write_bytes(b"PK\x03\x04 and no more")
    (folder / "words.json").write_text("these are words")
    (folder / "proto.json").write_text(good.replace('"about":', '"__proto__": {"polluted": 1}, "about":'))
    (folder / "deep.json").write_text("[" * 100_000)

    said = browse("files.mjs", designer, "refuses_hostile_files", str(folder))
    for name, reason in {
        "bomb.zip": "is larger than 16 MiB",
        "elsewhere.zip": "is not in the archive",
        "many.zip": "too many files",
        "markup.zip": "<img src=x onerror=alert(1)>",
        "nan.zip": "mass: must be a finite number",
        "torn.zip": "is not a whole ZIP archive",
        "words.json": "is not JSON",
        "proto.json": "__proto__ is not a field here",
        "deep.json": "is not JSON",
    }.items():
        assert reason in said.pop(name), name
    assert not said


def test_meshes_of_other_programs_become_parts_of_their_mass_or_are_refused(
    designer: str, browse: Browse, tmp_path: Path
) -> None:
    folder = tmp_path / "meshes"
    folder.mkdir()
    box = trimesh.creation.box((2.0, 0.5, 1.0))
    box.apply_translation((3.0, 4.0, 5.0))
    trimesh.Scene(box).export(folder / "a_box.glb")
    ball = trimesh.creation.icosphere(subdivisions=2, radius=400.0)
    ball.export(folder / "b_ball.stl")
    opened = trimesh.Trimesh(box.vertices, box.faces[1:], process=False)
    trimesh.Scene(opened).export(folder / "c_open.glb")
    (folder / "d_words.gltf").write_text("these are words")
    pointing = {
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "file:///etc/passwd", "byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    }
    (folder / "e_elsewhere.gltf").write_text(json.dumps(pointing))

    seen = browse("files.mjs", designer, "takes_meshes_of_other_programs", str(folder))
    taken = design.loads(json.dumps(seen["design"])).link("column").parts
    assert [(part.name, part.source) for part in taken] == [("a_box", "a_box.glb"), ("b_ball", "b_ball.stl")]
    of_box, of_ball = (mass.of_part(part) for part in taken)
    assert of_box.mass == pytest.approx(STEEL * 1.0)
    # glTF has y up, a link z
    assert of_box.centre == pytest.approx([3.0, -5.0, 4.0])
    assert of_ball.mass == pytest.approx(STEEL * ball.volume * 1e-9)
    assert "is not closed" in seen["refused"].pop("c_open.glb")
    assert "cannot be read as a mesh" in seen["refused"].pop("d_words.gltf")
    assert "cannot be read as a mesh" in seen["refused"].pop("e_elsewhere.gltf")
    assert not seen["refused"]
