"""Parts: closed surfaces, and masses against closed forms and another program."""

from __future__ import annotations

import json
import math
from pathlib import Path

import msgspec
import numpy as np
import pytest
import trimesh

from seacrane import design
from seacrane.design import imported, mass, mesh, standard
from seacrane.design.parts import STEEL, Box, Drum, Girder, Imported, Lug, Part, Sheave, Station, Tube
from seacrane.errors import DesignError


def girder(*sections: tuple[float, float, float, float], thickness: float = 0.02, y: float = 0.0) -> Girder:
    stations = tuple(Station(x=x, top=top, bottom=bottom, width=width) for x, top, bottom, width in sections)
    return Girder(name="girder", stations=stations, thickness=thickness, y=y)


PARTS: dict[str, Part] = {
    "girder": girder((-0.5, 0.4, -0.4, 0.9), (5, 0.9, -0.5, 0.9), (12, 0.3, -0.3, 0.6), y=0.7),
    "tube": Tube(name="tube", start=(0, 0, 0), end=(0, 0, 4), diameter=2, end_diameter=2, thickness=0.05),
    "cone": Tube(name="cone", start=(1, 1, 0), end=(3, -1, 4), diameter=2, end_diameter=1, thickness=0.05),
    "cross tube": Tube(name="cross", start=(0, -1, 0), end=(0, 1, 0), diameter=0.2, end_diameter=0.2, thickness=0.05),
    "lug": Lug(
        name="lug", x=1, z=-1, root_x=1.2, root_z=0, root_width=1.2, radius=0.3, hole=0.2, thickness=0.05, gap=0.3
    ),
    "round lug": Lug(
        name="lug", x=0, z=0, root_x=0.1, root_z=0, root_width=0.2, radius=0.3, hole=0.2, thickness=0.05, gap=0.3
    ),
    "sheave": Sheave(name="sheave", x=1, z=2, radius=0.6, groove=0.1, width=0.2, hole=0.2),
    "drum": Drum(name="drum", x=0, z=1, radius=0.5, length=1.5, flange=0.8, thickness=0.04),
    "box": Box(name="box", centre=(1, 2, 3), size=(1, 2, 3)),
    "cabin": Box(name="cabin", centre=(1, 2, 3), size=(1, 2, 3), thickness=0.1),
}


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS)
def test_a_part_is_closed_and_weighs_what_another_program_finds(part: Part) -> None:
    surface = mesh.mesh(part)
    other = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    assert other.is_watertight
    assert other.is_winding_consistent
    other.density = part.density
    ours = mass.of_part(part)
    assert ours.mass == pytest.approx(other.mass, rel=1e-9)
    np.testing.assert_allclose(ours.centre, other.center_mass, atol=1e-9)
    np.testing.assert_allclose(ours.inertia, other.moment_inertia, atol=1e-9 * float(np.max(ours.inertia)))
    assert ours.mass > 0
    assert np.all(np.linalg.eigvalsh(ours.inertia) > 0)


def test_a_box_girder_weighs_its_plates() -> None:
    body = mass.of_part(girder((0, 0.5, -0.5, 1), (10, 0.5, -0.5, 1)))
    volume = 10 * 1 * 1 - 9.96 * 0.96 * 0.96
    assert body.mass == pytest.approx(STEEL * volume, rel=1e-12)
    np.testing.assert_allclose(body.centre, [5, 0, 0], atol=1e-9)
    solid = [STEEL * v * (a * a + b * b) / 12 for v, a, b in ((10, 10, 1), (9.96 * 0.96**2, 9.96, 0.96))]
    assert body.inertia[1, 1] == pytest.approx(solid[0] - solid[1], rel=1e-9)


def test_a_tube_and_a_drum_weigh_their_closed_forms_within_the_corners_of_a_circle() -> None:
    tube = mass.of_part(PARTS["tube"])
    assert tube.mass == pytest.approx(STEEL * math.pi * (1 - 0.95**2) * 4, rel=5e-3)
    assert tube.inertia[2, 2] == pytest.approx(tube.mass * (1 + 0.95**2) / 2, rel=5e-3)
    drum = mass.of_part(PARTS["drum"])
    barrel, flanges = math.pi * (0.5**2 - 0.46**2) * 1.5, 2 * math.pi * (0.8**2 - 0.5**2) * 0.04
    assert drum.mass == pytest.approx(STEEL * (barrel + flanges), rel=5e-3)
    np.testing.assert_allclose(drum.centre, [0, 0, 1], atol=1e-9)


def test_a_lug_is_the_hull_of_its_eye_and_its_root() -> None:
    """Two tangents from the corners of the root to the circle: area by the shoelace over the true hull."""
    from scipy.spatial import ConvexHull

    angles = np.linspace(0, 2 * math.pi, 2000)
    circle = np.column_stack([1 + 0.3 * np.cos(angles), -1 + 0.3 * np.sin(angles)])
    along = np.array([0.2, 1.0]) / math.hypot(0.2, 1.0)
    aside = np.array([-along[1], along[0]])
    root = np.array([1.2, 0.0]) + np.array([[0.6], [-0.6]]) * aside
    area = ConvexHull(np.concatenate([circle, root])).volume - math.pi * 0.1**2
    assert mass.of_part(PARTS["lug"]).mass == pytest.approx(STEEL * 0.1 * area, rel=1e-2)


def test_parts_together_weigh_their_sum_about_their_common_centre() -> None:
    a, b = Box(name="a", centre=(0, 0, 0), size=(1, 1, 1)), Box(name="b", centre=(1, 0, 0), size=(1, 1, 1))
    both = mass.combined([mass.of_part(a), mass.of_part(b)])
    whole = mass.of_part(Box(name="c", centre=(0.5, 0, 0), size=(2, 1, 1)))
    assert both.mass == pytest.approx(whole.mass)
    np.testing.assert_allclose(both.centre, whole.centre, atol=1e-12)
    np.testing.assert_allclose(both.inertia, whole.inertia, atol=1e-8)


@pytest.mark.parametrize("name", design.names())
def test_every_design_is_furnished_with_sound_parts_and_keeps_its_masses(name: str) -> None:
    crane = design.load(name)
    furnished = standard.furnished(crane)
    assert design.check(furnished) == []
    for bare, link in zip(crane.links, furnished.links, strict=True):
        assert link.parts
        assert (link.mass, link.com, link.inertia) == (bare.mass, bare.com, bare.inertia)
        for part in link.parts:
            assert trimesh.Trimesh(*_arrays(part), process=False).is_watertight
    assert design.loads(design.to_json(furnished)) == furnished


def test_sheaves_and_drum_off_the_axis_of_their_link_are_borne_by_plates_that_reach_it() -> None:
    crane = standard.furnished(design.load("offshore-100t"))
    for link, name, pin in (
        ("boom", "sheave 1", crane.hoist.sheaves[0]),
        ("column", "drum", crane.hoist.drum),
    ):
        parts = {part.name: part for part in crane.link(link).parts}
        bracket, borne = parts[f"{name} bracket"], parts[name]
        assert isinstance(bracket, Lug)
        assert isinstance(borne, (Sheave, Drum))
        assert (bracket.x, bracket.z) == (pin.x, pin.z)
        across = bracket.root_z if link == "boom" else bracket.root_x
        assert across == pytest.approx(0.0), "the root is on the axis of the link"
        wide = borne.width if isinstance(borne, Sheave) else borne.length
        assert bracket.gap > wide, "it turns between the plates"
    assert "sheave 2 bracket" not in {part.name for part in crane.link("jib").parts}, "the tip is on the axis"


def _arrays(part: Part) -> tuple[np.ndarray, np.ndarray]:
    surface = mesh.mesh(part)
    return surface.vertices, surface.faces


def test_the_standard_boom_weighs_what_the_design_says() -> None:
    crane = standard.furnished(design.load("offshore-100t"))
    for name in ("boom", "jib"):
        link = crane.link(name)
        body = mass.of_link(link)
        assert body.mass == pytest.approx(link.mass, rel=1e-3)
        assert body.centre[0] == pytest.approx(link.com[0], rel=0.25)
        assert body.inertia[1, 1] == pytest.approx(link.inertia[1], rel=0.25)


def test_weighing_a_crane_takes_the_masses_of_its_parts() -> None:
    crane = design.load("a-frame-30t")
    weighed = mass.weighed(crane)
    assert design.check(weighed) == []
    frame = weighed.link("frame")
    assert frame.mass == pytest.approx(sum(mass.of_part(part).mass for part in frame.parts))
    bare = design.load("offshore-100t")
    assert mass.weighed(bare) == bare


def test_parts_that_cannot_be_built_are_told_all_at_once() -> None:
    crane = design.load("offshore-100t")
    bad = (
        girder((0, 0.5, -0.5, 1), (0, -0.1, 0.1, 0.03)),
        msgspec.structs.replace(PARTS["tube"], thickness=1.2, end=(0, 0, 0)),
        msgspec.structs.replace(PARTS["lug"], hole=0.7),
        msgspec.structs.replace(PARTS["drum"], flange=0.4),
        msgspec.structs.replace(PARTS["cabin"], size=(1, 0.1, 0), name="drum"),
    )
    links = (msgspec.structs.replace(crane.links[0], parts=bad), *crane.links[1:])
    problems = {p.path.removeprefix("links[column].parts"): str(p) for p in design.check(
        msgspec.structs.replace(crane, links=links)
    )}  # fmt: skip
    assert set(problems) == {
        "",
        "[girder].thickness",
        "[girder].stations",
        "[girder].stations[1].top",
        "[tube].thickness",
        "[tube].end",
        "[lug].hole",
        "[drum].radius",
        "[drum].size",
        "[drum].thickness",
    }
    assert "must be less than the radius (got 1.2); allowed: below 1 m" in problems["[tube].thickness"]


def test_an_unknown_kind_of_part_gets_the_nearest() -> None:
    data = json.loads(design.to_json(standard.furnished(design.load("offshore-100t"))))
    data["links"][1]["parts"][0]["kind"] = "girdr"
    del data["links"][2]["parts"][0]["kind"]
    with pytest.raises(DesignError) as refused:
        design.loads(json.dumps(data))
    first, second = map(str, refused.value.problems)
    assert "links[boom].parts[boom].kind: is none of the known values (got 'girdr')" in first
    assert "Did you mean 'girder'?" in first
    assert "links[jib].parts[jib].kind: is missing; allowed: girder, tube, lug, sheave, drum, box, mesh" in second


def _triangles(part: Part) -> trimesh.Trimesh:
    return trimesh.Trimesh(*_arrays(part), process=False)


@pytest.mark.parametrize("kind", ["stl", "glb"])
def test_a_mesh_of_another_program_is_a_part_of_the_same_mass(kind: str, tmp_path: Path) -> None:
    box = PARTS["box"]
    surface = _triangles(box)
    if kind == "glb":
        surface.apply_transform([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])  # y up
    else:
        surface.apply_scale(1000)
    surface.export(tmp_path / f"house.{kind}")
    part = imported.read(tmp_path / f"house.{kind}", unit="mm" if kind == "stl" else "m")
    body, expected = mass.of_part(part), mass.of_part(box)
    assert part.name == "house"
    assert body.mass == pytest.approx(expected.mass, rel=1e-6)
    np.testing.assert_allclose(body.centre, expected.centre, atol=1e-5)
    crane = design.load("offshore-100t")
    links = (msgspec.structs.replace(crane.links[0], parts=(part,)), *crane.links[1:])
    whole = msgspec.structs.replace(crane, links=links)
    assert design.loads(design.to_json(whole)) == whole


def test_meshes_that_cannot_be_parts_are_refused_with_the_reason(tmp_path: Path) -> None:
    surface = _triangles(PARTS["box"])
    surface.update_faces(np.arange(len(surface.faces)) > 0)
    surface.export(tmp_path / "open.stl")
    (tmp_path / "text.stl").write_bytes(b"\x00" * 90)
    (tmp_path / "other.gltf").write_text('{"asset": {"version": "2.0"}, "buffers": [{"uri": "../secret.bin"}]}')
    (tmp_path / "crane.step").write_text("")
    for name, message in (
        ("open.stl", "is not closed, so it has no mass: 3 edges"),
        ("text.stl", "cannot be read as a mesh|has no triangles"),
        ("other.gltf", "cannot be read as a mesh|has no triangles"),
        ("crane.step", r"is not a mesh that can be read \(got '.step'\); allowed: .stl, .glb, .gltf"),
    ):
        with pytest.raises(DesignError, match=message):
            imported.read(tmp_path / name)
    with pytest.raises(DesignError, match="is not a unit of length"):
        imported.read(tmp_path / "open.stl", unit="kg")


def test_a_surface_in_a_design_file_must_be_closed() -> None:
    crane = design.load("offshore-100t")
    whole = mesh.mesh(PARTS["box"])
    holed = mesh.encoded(mesh.Mesh(whole.vertices, whole.faces[1:]))
    parts = (
        Imported(name="holed", source="a.stl", surface=holed),
        Imported(name="words", source="b.stl", surface="no mesh"),
    )
    links = (msgspec.structs.replace(crane.links[0], parts=parts), *crane.links[1:])
    first, second = design.check(msgspec.structs.replace(crane, links=links))
    assert first.path == "links[column].parts[holed].surface"
    assert "is not closed" in first.message
    assert "is not a binary STL" in second.message


def test_a_mesh_inside_out_is_turned_and_one_that_encloses_nothing_refused() -> None:
    solid = trimesh.creation.box((2.0, 0.5, 1.0))
    solid.invert()
    assert solid.volume < 0
    part = imported.part(solid.export(file_type="stl"), "turned.stl")
    assert mass.of_part(part).mass == pytest.approx(STEEL * 1.0)
    flat = trimesh.Trimesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 1)], process=False)
    with pytest.raises(DesignError, match="encloses no volume, so it has no mass"):
        imported.part(flat.export(file_type="stl"), "flat.stl")
    crane = design.load("a-frame-30t")
    inner = mesh.Mesh(mesh.decoded(part.surface).vertices, mesh.decoded(part.surface).faces[:, ::-1])
    spoilt = msgspec.structs.replace(part, surface=mesh.encoded(inner))
    links = (msgspec.structs.replace(crane.links[0], parts=(spoilt,)), *crane.links[1:])
    (problem,) = design.check(msgspec.structs.replace(crane, links=links))
    assert problem.path == "links[frame].parts[turned].surface"
    assert "is inside out or encloses no volume" in problem.message


def test_a_mesh_that_asks_for_more_than_a_part_is_refused_at_once() -> None:
    whole = trimesh.Scene(trimesh.creation.box()).export(file_type="glb")
    size = int.from_bytes(whole[12:16], "little")
    tree, rest = json.loads(whole[20 : 20 + size]), whole[20 + size :]

    def packed(changed: object) -> bytes:
        text = json.dumps(changed).encode()
        text += b" " * (-len(text) % 4)
        length = (20 + len(text) + len(rest)).to_bytes(4, "little")
        return whole[:8] + length + len(text).to_bytes(4, "little") + b"JSON" + text + rest

    assert mass.of_part(imported.part(packed(tree), "box.glb")).mass == pytest.approx(STEEL)
    nodes = [{"mesh": 0, "translation": [3.0 * i, 0, 0]} for i in range(200_000)]
    crowd = tree | {"nodes": nodes, "scenes": [{"nodes": list(range(len(nodes)))}], "scene": 0}
    empty = tree | {"accessors": [{"componentType": 5126, "count": 2**28, "type": "VEC3"}]}
    for changed in (crowd, empty):
        with pytest.raises(DesignError, match="has too many nodes or numbers for a part"):
            imported.part(packed(changed), "many.glb")
    for odd, words in (([], "cannot be read as a mesh"), (tree | {"nodes": 3}, "its nodes and accessors are no lists")):
        with pytest.raises(DesignError, match=words):
            imported.part(packed(odd), "odd.glb")
    fine = trimesh.creation.icosphere(subdivisions=7)
    with pytest.raises(DesignError, match=r"has too many triangles for a part \(got 327680\); allowed: at most 100000"):
        imported.part(fine.export(file_type="stl"), "fine.stl")
