"""The mechanical editor in a real browser, held against the geometry and masses of the Python package."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
import trimesh

from seacrane import design
from seacrane.design import geometry, mass, mesh, standard, workspace
from seacrane.design.parts import STEEL

Browse = Callable[..., Any]
SCRIPT = "mechanical.mjs"


def test_distances_between_pins_are_those_of_the_geometry(designer: str, browse: Browse) -> None:
    seen = browse(SCRIPT, designer, "measures_between_pins_and_on_the_steel")
    crane = design.load("offshore-100t")
    posture = seen["posture"]
    boom, jib = crane.cylinders
    frames = geometry.frames(crane, posture)
    ends = {
        "joint luff to tip": (frames["boom"].origin, geometry.tip(crane, posture)),
        "boom_cylinder base to boom_cylinder eye": (boom.base, boom.eye),
        "jib_cylinder base to jib_cylinder eye": (jib.base, jib.eye),
        "drum to sheave 1": (crane.hoist.drum, crane.hoist.sheaves[0]),
    }
    assert set(seen["pins"]) == set(ends)
    for name, pair in ends.items():
        a, b = (geometry.position(crane, end, posture) if isinstance(end, design.Attachment) else end for end in pair)
        measured = seen["pins"][name]
        np.testing.assert_allclose(measured["from"], a, atol=1e-9, err_msg=name)
        np.testing.assert_allclose(measured["to"], b, atol=1e-9, err_msg=name)
        length = float(np.linalg.norm(b - a))
        assert measured["value"] == pytest.approx(length)
        assert f"{length:.3f} m" in measured["text"]
    steel = posed(crane, start())
    for pair in (seen["steel"], seen["left"]):
        assert off(steel, pair["from"], pair["to"]) < 1e-3
    assert max(seen["steel"]["from"][1], seen["steel"]["to"][1]) < 0, "the side that is seen first"
    assert min(seen["left"]["from"][1], seen["left"]["to"][1]) > 0, "that side is cut away"


def start() -> dict[str, float]:
    """The posture in which the page shows a crane first: each joint 0.6 up its range."""
    crane = design.load("offshore-100t")
    return {
        joint.name: 0.0 if joint.limits is None else joint.limits[0] + 0.6 * (joint.limits[1] - joint.limits[0])
        for joint in crane.joints
    }


def posed(crane: design.Crane, posture: dict[str, float]) -> trimesh.Trimesh:
    """The steel of a crane with standard parts."""
    frames = geometry.frames(crane, posture)
    shapes = []
    for link in standard.furnished(crane).links:
        frame = frames[link.name]
        shapes += [mesh.mesh(part).moved(frame.rotation, frame.origin) for part in link.parts]
    whole = mesh.joined(shapes)
    return trimesh.Trimesh(whole.vertices, whole.faces, process=False)


def off(steel: trimesh.Trimesh, *points: list[float]) -> float:
    """How far the points are from the surface at most [m]."""
    _, distance, _ = trimesh.proximity.closest_point_naive(steel, np.array(points))
    return float(np.max(distance))


def test_workspace_and_centre_of_mass_are_those_of_the_package(designer: str, browse: Browse) -> None:
    seen = browse(SCRIPT, designer, "shows_the_workspace_and_the_centre_of_mass")
    assert len(seen) == 3
    for name, shown in seen.items():
        crane = design.load(name)
        section = workspace.section(crane)
        assert shown["area"] == pytest.approx(section.area, rel=0.01), name
        assert shown["volume"] == pytest.approx(section.volume(crane), rel=0.01), name
        assert ("swept in slewing" in shown["text"]) == (crane.slew is not None)
        frames = geometry.frames(crane, shown["posture"])
        moments = sum(link.mass * frames[link.name].point(np.array(link.com)) for link in crane.links)
        np.testing.assert_allclose(shown["centre"], moments / sum(link.mass for link in crane.links), atol=1e-9)


def test_a_crane_is_cut_open_taken_apart_and_moved_through_its_range(designer: str, browse: Browse) -> None:
    seen = browse(SCRIPT, designer, "cuts_open_takes_apart_and_moves")
    crane = design.load("offshore-100t")
    whole = pixels(seen["whole"])
    assert differing(whole, pixels(seen["together"])) < 1e-4, "put together again it is the same picture"
    assert differing(whole, pixels(seen["closed"])) < 1e-4
    assert differing(whole, pixels(seen["apart"])) > 0.005
    # what a cut lays open is drawn in a colour of its own, and a cut beyond the crane leaves none of it
    assert laid_open(whole) == 0
    assert laid_open(pixels(seen["cut"])) > 100
    assert laid_open(pixels(seen["gone"])) == 0
    assert differing(pixels(seen["gone"]), pixels(seen["cut"])) > 0.01

    postures = seen["postures"]
    for joint in crane.joints:
        passed = [posture[joint.name] for posture in postures]
        low, high = joint.limits or (0.0, 2 * np.pi)
        assert min(passed) == pytest.approx(low, abs=0.01 * (high - low))
        assert max(passed) == pytest.approx(high, abs=0.01 * (high - low))
        assert low - 1e-9 <= min(passed)
        assert max(passed) <= high + 1e-9


def pixels(path: str) -> np.ndarray:
    """Red, green and blue, 0 to 1."""
    return matplotlib.image.imread(path)[:, :, :3]


def differing(a: np.ndarray, b: np.ndarray) -> float:
    """The share of pixels that are not alike."""
    return float(np.mean(np.max(np.abs(a - b), axis=2) > 0.05))


def laid_open(picture: np.ndarray) -> int:
    """How many pixels have the colour of a cut."""
    cut = np.array([0xC2, 0x25, 0x5C]) / 255
    return int(np.count_nonzero(np.max(np.abs(picture - cut), axis=2) < 0.1))


def test_a_change_of_a_part_shows_in_both_editors_and_its_mass_is_that_of_the_package(
    designer: str, browse: Browse
) -> None:
    seen = browse(SCRIPT, designer, "edits_parts_in_both_editors_at_once")
    own = design.loads(json.dumps(seen["own"]))
    body = mass.of_link(own.link("boom"))
    assert own.link("boom").mass == 48e3
    assert seen["mass"] == pytest.approx(body.mass, rel=1e-9)
    weighed = design.loads(json.dumps(seen["weighed"])).link("boom")
    assert weighed.mass == pytest.approx(body.mass, rel=1e-9)
    np.testing.assert_allclose(weighed.com, body.centre, atol=1e-9)
    np.testing.assert_allclose(weighed.inertia, np.diag(body.inertia), rtol=1e-9)


def test_the_volume_of_each_saved_stl_has_the_mass_of_its_link(designer: str, browse: Browse) -> None:
    seen = browse(SCRIPT, designer, "saves_meshes_as_stl")
    for name, files in seen.items():
        crane = standard.furnished(design.load(name))
        assert set(files) == {link.name for link in crane.links}
        for link in crane.links:
            shape = trimesh.load(files[link.name], force="mesh")
            assert shape.is_watertight, link.name
            assert shape.volume * STEEL == pytest.approx(mass.of_link(link).mass, rel=0.005), link.name
    boom = trimesh.load(seen["offshore-100t"]["boom"], force="mesh")
    assert boom.volume * STEEL == pytest.approx(48e3, rel=0.005), "standard parts weigh what the design says"


def test_the_archive_of_the_page_holds_the_design_that_it_saves(designer: str, browse: Browse) -> None:
    seen = browse(SCRIPT, designer, "exports_what_is_designed")
    saved = design.loads(json.dumps(seen["design"]))
    assert design.archive.load_archive(seen["path"]) == saved
    with zipfile.ZipFile(Path(seen["path"])) as archive:
        told = json.loads(archive.read("provenance.json"))
        masses = json.loads(archive.read("mass_properties.json"))["links"]
    assert told["design_sha256"] == design.archive.provenance(saved)
    assert masses["jib"]["parts"]["mass_kg"] == pytest.approx(24e3, rel=0.005)
