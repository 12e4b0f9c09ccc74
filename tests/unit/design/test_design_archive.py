"""What leaves the house with a design: read back, and by other programs."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import math
import tracemalloc
import zipfile
from pathlib import Path, PureWindowsPath
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
import trimesh

from seacrane import design
from seacrane.design import Crane, archive, chart, geometry, mass, mesh, planar, robot, standard
from seacrane.errors import DesignError
from seacrane.units import GRAVITY


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("export") / "crane.zip"
    archive.export(design.load("offshore-100t"), path)
    return path


def test_an_exported_crane_reads_back_equal_and_again_gives_the_same_bytes(exported: Path, tmp_path: Path) -> None:
    crane = archive.load_archive(exported)
    assert crane == design.load("offshore-100t")
    archive.export(crane, tmp_path / "again.zip")
    assert (tmp_path / "again.zip").read_bytes() == exported.read_bytes()


def test_the_archive_says_what_it_was_made_from(exported: Path) -> None:
    with zipfile.ZipFile(exported) as files:
        assert {
            "design.json",
            "meshes/boom.glb",
            "meshes/boom.stl",
            "mass_properties.json",
            "load_chart.csv",
            "load_chart.json",
            "offshore-100t.xml",
            "offshore-100t.urdf",
            "sheet.pdf",
            "provenance.json",
        } <= set(files.namelist())
        written = json.loads(files.read("provenance.json"))
        assert written["design_sha256"] == hashlib.sha256(files.read("design.json")).hexdigest()
        assert "Not a certified load chart" in written["notice"]
        assert files.read("sheet.pdf").startswith(b"%PDF-")
        masses = json.loads(files.read("mass_properties.json"))["links"]["boom"]
        assert masses["design"]["mass_kg"] == 48e3
        assert masses["parts"]["from"] == "standard parts, the link has none of its own"
        assert any("dynamic factor 1.1" in text for text in json.loads(files.read("load_chart.json"))["conditions"])


def test_the_chart_in_the_archive_is_that_of_the_design(exported: Path) -> None:
    crane = design.load("offshore-100t")
    with zipfile.ZipFile(exported) as files:
        rows = list(csv.DictReader(io.StringIO(files.read("load_chart.csv").decode())))
    assert list(rows[0]) == ["mode", "radius_m", "swl_t", "governs"]
    assert {row["mode"] for row in rows} == {mode.name for mode in chart.modes(crane)}
    for ours, row in zip(chart.curve(crane), rows, strict=False):
        assert float(row["swl_t"]) == pytest.approx(ours.swl / 1e3, rel=1e-5)
        assert row["governs"] == ours.governs


def test_another_program_reads_meshes_of_the_same_steel(exported: Path) -> None:
    crane = standard.furnished(design.load("offshore-100t"))
    with zipfile.ZipFile(exported) as files:
        for link in crane.links:
            steel = sum(mass.of_part(part).mass / part.density for part in link.parts)
            for kind in ("glb", "stl"):
                content = io.BytesIO(files.read(f"meshes/{link.name}.{kind}"))
                other = trimesh.load(content, file_type=kind, force="mesh")
                assert other.volume == pytest.approx(steel, rel=1e-3)
            boom = trimesh.load(io.BytesIO(files.read(f"meshes/{link.name}.glb")), file_type="glb", force="mesh")
            ours = mesh.joined([mesh.mesh(part) for part in link.parts])
            height = ours.vertices[:, 2]  # up in a link, y in glTF
            assert boom.bounds[:, 1] == pytest.approx([height.min(), height.max()], abs=1e-5)


@pytest.mark.parametrize("name", design.names())
def test_mujoco_finds_the_tip_the_cylinders_and_the_masses_of_the_mjcf_where_the_design_has_them(name: str) -> None:
    crane = design.load(name)
    model = mujoco.MjModel.from_xml_string(robot.mjcf(crane))
    data = mujoco.MjData(model)
    random = np.random.default_rng(5)
    posture = {joint.name: float(random.uniform(*(joint.limits or (-3.0, 3.0)))) for joint in crane.joints}
    for joint, q in posture.items():
        data.joint(joint).qpos = q
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(
        data.site(f"sheave {len(crane.hoist.sheaves)}").xpos, geometry.tip(crane, posture), atol=1e-9
    )
    for cylinder in crane.cylinders:
        assert data.ten(cylinder.name).length[0] == pytest.approx(geometry.cylinder_length(crane, cylinder, posture))
    assert model.body_mass.sum() == pytest.approx(sum(link.mass for link in crane.links))
    for joint in crane.joints:
        limits = model.joint(joint.name).range
        assert tuple(limits) == pytest.approx(joint.limits or (0.0, 0.0))
    other = mujoco.MjModel.from_xml_string(robot.urdf(crane))
    assert other.nv == len(crane.joints)
    assert other.body_mass.sum() == pytest.approx(sum(link.mass for link in crane.links))


@pytest.mark.parametrize("name", design.names())
def test_in_its_key_frame_the_crane_of_the_mjcf_is_held_by_its_cylinders(name: str) -> None:
    crane = design.load(name)
    model = mujoco.MjModel.from_xml_string(robot.mjcf(crane))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("half-way").id)
    mujoco.mj_forward(model, data)
    assert {c.name for c in crane.cylinders} == {model.actuator(i).name for i in range(model.nu)}
    for c in crane.cylinders:
        low, high = model.joint(c.moves).range
        assert float(data.joint(c.moves).qpos[0]) == pytest.approx(0.5 * (low + high))
        pull, push = model.actuator(c.name).ctrlrange
        assert pull < float(data.actuator(c.name).ctrl[0]) < push
        weight = float(data.joint(c.moves).qfrc_bias[0])
        assert float(data.joint(c.moves).qfrc_actuator[0]) == pytest.approx(weight, rel=1e-9, abs=1e-3)
    if {c.moves for c in crane.cylinders} | {crane.slew and crane.slew.joint} >= {joint.name for joint in crane.joints}:
        assert np.abs(data.qacc).max() < 1e-8  # nothing moves where every joint has its cylinders


@pytest.mark.parametrize("name", design.names())
def test_a_joint_of_the_urdf_takes_what_its_cylinders_give_in_the_mjcf(name: str) -> None:
    crane = design.load(name)
    model = mujoco.MjModel.from_xml_string(robot.mjcf(crane))
    data, step = mujoco.MjData(model), 1e-5
    limits = {
        joint.get("name"): joint.find("limit").attrib
        for joint in ElementTree.fromstring(robot.urdf(crane)).iter("joint")
    }
    for c in crane.cylinders:
        most = 0.0
        for q in np.linspace(*model.joint(c.moves).range, 200):
            lengths = []
            for shift in (-step, step):
                data.joint(c.moves).qpos = q + shift
                mujoco.mj_forward(model, data)
                lengths.append(float(data.ten(c.name).length[0]))
            lever = abs(lengths[1] - lengths[0]) / (2 * step)
            most = max(most, lever * float(np.abs(model.actuator(c.name).ctrlrange).max()))
        assert float(limits[c.moves]["effort"]) == pytest.approx(most, rel=2e-3)
    if crane.slew:
        assert float(limits[crane.slew.joint]["velocity"]) == crane.slew.speed
        assert "lower" not in limits[crane.slew.joint]


def test_the_weight_that_mujoco_finds_on_each_joint_is_what_the_chart_bears_first() -> None:
    random = np.random.default_rng(8)
    for name in design.names():
        crane = design.load(name)
        model = mujoco.MjModel.from_xml_string(robot.mjcf(crane))
        data = mujoco.MjData(model)
        for _ in range(3):
            at = {joint.name: float(random.uniform(*joint.limits)) for joint in planar.plane_joints(crane)}
            for joint, q in at.items():
                data.joint(joint).qpos = q
            mujoco.mj_forward(model, data)
            plane = planar.Plane(crane, {joint: np.asarray(q) for joint, q in at.items()})
            for joint in at:
                own = GRAVITY * float(plane.own_moment(joint, (0.0, 1.0)))
                assert float(data.joint(joint).qfrc_bias[0]) == pytest.approx(own, rel=1e-9, abs=1e-3)


def test_the_mjcf_of_the_archive_loads_with_its_meshes(exported: Path) -> None:
    with zipfile.ZipFile(exported) as files:
        assets = {name: files.read(name) for name in files.namelist() if name.endswith(".stl")}
        model = mujoco.MjModel.from_xml_string(files.read("offshore-100t.xml").decode(), assets)
    assert model.nmesh == 3
    assert model.ngeom == 3


def _zip(path: Path, files: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as out:
        for name, data in files.items():
            out.writestr(name, data)
    return path


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({"other.json": b"{}"}, "design.json: is not in the archive, so it is not a crane"),
        ({"design.json": b"[]"}, "does not hold a crane"),
        ({"design.json": b"{"}, "is not JSON"),
        ({"design.json": b" " * (17 * 2**20)}, "is larger than 16 MiB"),
        ({f"{i}": b"" for i in range(1001)}, "has too many files for a design"),
        ({"../design.json": b"{}"}, "is not in the archive"),
        ({f"{i:0200}": b"" for i in range(5000)}, "has too many files for a design"),
    ],
    ids=["no design", "no crane", "no JSON", "a bomb", "many files", "out of the folder", "a long list of files"],
)
def test_a_hostile_archive_is_refused_with_the_reason(files: dict[str, bytes], message: str, tmp_path: Path) -> None:
    path = _zip(tmp_path / "bad.zip", files)
    before = set(tmp_path.iterdir())
    with pytest.raises(DesignError, match=message):
        archive.load_archive(path)
    assert set(tmp_path.iterdir()) == before


def test_an_archive_with_any_bytes_changed_is_whole_or_refused(tmp_path: Path) -> None:
    crane = design.load("offshore-100t")
    good = design.to_json(crane).encode()
    whole, random = _zip(tmp_path / "crane.zip", {"design.json": good}).read_bytes(), np.random.default_rng(4)
    reasons = []
    for _ in range(400):
        spoilt = bytearray(whole)
        for _ in range(random.integers(1, 8)):
            spoilt[random.integers(len(spoilt))] = random.integers(256)
        try:
            assert archive.unpacked(bytes(spoilt), "spoilt.zip") == crane
        except DesignError as error:
            reasons.append(str(error))
    assert len(reasons) > 200
    assert all(reason.startswith("spoilt.zip") for reason in reasons)


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_design_packed_by_a_method_that_asks_for_memory_is_refused(method: int, tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "other.zip", "w", method) as files:
        files.writestr("design.json", design.to_json(design.load("offshore-100t")))
    with pytest.raises(DesignError, match=r"packed in another way than seacrane packs; allowed: deflated"):
        archive.load_archive(tmp_path / "other.zip")


def test_a_long_list_of_files_is_refused_before_it_is_read(tmp_path: Path) -> None:
    """A list of 60 MB with a quarter of a million files, and one that a record for 64 bits leads to."""
    listed = _zip(tmp_path / "one.zip", {"design.json": b"{}"}).read_bytes()
    head, end = listed[: listed.index(b"PK\x01\x02")], listed.index(b"PK\x05\x06")
    entry = listed[len(head) : end]
    many = entry * (60 * 2**20 // len(entry))
    long = head + many + listed[end : end + 12] + len(many).to_bytes(4, "little") + listed[end + 16 :]
    with zipfile.ZipFile(io.BytesIO(long[: len(head)] + entry + listed[end:])) as sound:
        assert sound.namelist() == ["design.json"]
    tracemalloc.start()
    with pytest.raises(DesignError, match="has too many files for a design"):
        archive.unpacked(long, "long.zip")
    assert tracemalloc.get_traced_memory()[1] < 2**20
    tracemalloc.stop()
    behind = listed[:end] + b"PK\x06\x07" + bytes(16) + listed[end:]
    with pytest.raises(DesignError, match="has too many files for a design"):
        archive.unpacked(behind, "behind.zip")


@pytest.mark.parametrize("name", ["../../up", "con", "<&a\\b:c*?> № 5 $\\frac$"])
def test_names_of_a_design_lead_out_of_no_folder_and_break_no_file(name: str) -> None:
    crane = design.load("a-frame-30t")
    data = json.loads(design.to_json(crane).replace('"crossbeam"', json.dumps(f"{name}/x")))
    data |= {"name": name, "about": "$\\frac{1}{$ a piece"}
    data["links"][0]["name"] = f"{name}/X"
    renamed = design.loads(json.dumps(data).replace('"frame"', json.dumps(f"{name}/X")))
    with zipfile.ZipFile(io.BytesIO(archive.packed(renamed))) as files:
        names = files.namelist()
        for path in names:
            inside = PureWindowsPath(path)
            assert not inside.is_absolute()
            assert not inside.drive
            assert ".." not in inside.parts
            assert not inside.is_reserved()
            assert not set(path) & set('\\:*?"<>|')
        assert len({path.casefold() for path in names}) == len(names)
        assets = {path: files.read(path) for path in names if path.endswith(".stl")}
        model = mujoco.MjModel.from_xml_string(
            files.read(next(path for path in names if path.endswith(".xml"))).decode(), assets
        )
    assert model.nmesh == 2
    assert model.body(f"{name}/x").mass == pytest.approx(crane.links[1].mass)


def test_a_damaged_archive_is_refused_with_the_reason(exported: Path, tmp_path: Path) -> None:
    whole = exported.read_bytes()
    (tmp_path / "cut.zip").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(DesignError, match="is not a whole ZIP archive"):
        archive.load_archive(tmp_path / "cut.zip")
    with pytest.raises(DesignError, match="cannot be read"):
        archive.load_archive(tmp_path / "none.zip")


def test_a_crane_that_is_not_sound_is_not_exported(tmp_path: Path) -> None:
    import msgspec

    crane: Crane = design.load("offshore-100t")
    bad = msgspec.structs.replace(crane, bulk_modulus=math.nan)
    with pytest.raises(DesignError, match="bulk_modulus"):
        archive.export(bad, tmp_path / "bad.zip")
    assert list(tmp_path.iterdir()) == []
