"""Archives that are not what they should be: each is refused with a clear word, and nothing stays behind."""

import os
import stat
import tempfile
import zipfile
from pathlib import Path

import pytest

from seacrane import fmi
from seacrane.cosim import FmuSlave
from seacrane.errors import FmuError
from seacrane.fmi import archive as archive_room
from seacrane.fmi import xml as xml_room


@pytest.fixture
def scratch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in place of the system's for temporary files, to see what stays behind."""
    folder = tmp_path / "scratch"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def packed(path: Path, entries: dict[str, bytes | str], method: int = zipfile.ZIP_DEFLATED) -> Path:
    with zipfile.ZipFile(path, "w", method) as archive:
        for name, content in entries.items():
            archive.writestr(zipfile.ZipInfo(name), content, method)
    return path


def refused(path: Path, scratch: Path) -> str:
    with pytest.raises(FmuError) as caught:
        fmi.Fmu(path)
    assert list(scratch.iterdir()) == []
    assert [str(p) for p in fmi.check(path)]
    return str(caught.value)


DESCRIPTION = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g">
  <CoSimulation modelIdentifier="m"/>
  <ModelVariables><ScalarVariable name="x" valueReference="0"><Real/></ScalarVariable></ModelVariables>
  <ModelStructure/>
</fmiModelDescription>
"""


TWO = DESCRIPTION
THREE = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="g"><CoSimulation modelIdentifier="m"/>
<ModelVariables><Float64 name="x" valueReference="1" causality="parameter" start="1"/></ModelVariables>
<ModelStructure/></fmiModelDescription>
"""


def test_a_file_that_is_no_zip(tmp_path: Path, scratch: Path) -> None:
    path = tmp_path / "letter.fmu"
    path.write_text("Dear Sir")
    assert refused(path, scratch).endswith("letter.fmu: is not a ZIP archive, so it is not an FMU")
    assert "cannot be read: No such file or directory" in refused(tmp_path / "none.fmu", scratch)
    assert refused(tmp_path, scratch).endswith("is not a file")


def test_a_truncated_zip(tmp_path: Path, scratch: Path, piston_fmu: Path) -> None:
    path = tmp_path / "half.fmu"
    path.write_bytes(piston_fmu.read_bytes()[:2000])
    assert "is a truncated ZIP archive" in refused(path, scratch)


def test_a_zip_damaged_in_the_middle(tmp_path: Path, scratch: Path, piston_fmu: Path) -> None:
    content = bytearray(piston_fmu.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 50] = bytes(50)
    path = tmp_path / "damaged.fmu"
    path.write_bytes(content)
    with pytest.raises(FmuError, match="is a damaged ZIP archive"):
        fmi.Fmu(path)
    assert list(scratch.iterdir()) == []


def test_a_zip_without_a_model_description(tmp_path: Path, scratch: Path) -> None:
    message = refused(packed(tmp_path / "a.fmu", {"readme.txt": "hello"}), scratch)
    assert message == "modelDescription.xml: is not at the top of the archive, so it is not an FMU"


@pytest.mark.parametrize("name", ["../evil.txt", "/etc/evil", "a/../../evil", "C:/evil.txt"])
def test_paths_that_lead_out_of_the_archive(tmp_path: Path, scratch: Path, name: str) -> None:
    path = packed(tmp_path / "a.fmu", {"modelDescription.xml": DESCRIPTION, name: "x"})
    assert refused(path, scratch) == f"{name}: is a path that leads out of the archive"


def test_backslashes_in_paths(tmp_path: Path, scratch: Path) -> None:
    path = packed(tmp_path / "a.fmu", {"modelDescription.xml": DESCRIPTION, "binaries\\win64\\m.dll": "x"})
    assert "character that the standard forbids. FMI 2.0, section 2.3" in refused(path, scratch)


def test_links(tmp_path: Path, scratch: Path) -> None:
    path = tmp_path / "a.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        link = zipfile.ZipInfo("resources/link")
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(link, "/etc/passwd")
    assert refused(path, scratch).startswith("resources/link: is a link or a special file")


def test_too_many_entries_and_too_much_to_unpack(
    tmp_path: Path, scratch: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bomb = packed(tmp_path / "bomb.fmu", {"modelDescription.xml": DESCRIPTION, "zeros": bytes(4_000_000)})
    assert "times its size; allowed: 200 times" in refused(bomb, scratch)
    monkeypatch.setattr(archive_room, "MOST_ENTRIES", 3)
    many = packed(tmp_path / "many.fmu", {f"f{i}": "x" for i in range(4)})
    assert "the archive has 4 entries; allowed: at most 3" in refused(many, scratch)
    monkeypatch.setattr(archive_room, "LARGEST_UNPACKED", 2**20)
    large = packed(tmp_path / "large.fmu", {"noise": os.urandom(2**21)})
    assert "the archive unpacks to 2 MiB; allowed: at most 1 MiB" in refused(large, scratch)
    monkeypatch.setattr(archive_room, "LARGEST_ARCHIVE", 2**20)
    assert "is larger than 1 MiB" in refused(large, scratch)


def test_all_problems_of_an_archive_come_at_once(tmp_path: Path) -> None:
    path = packed(tmp_path / "a.fmu", {"../a": "x", "/b": "x", "c\\d": "x"})
    with pytest.raises(FmuError) as caught:
        fmi.read(path)
    assert len(caught.value.problems) == 3


def test_entities_and_document_types_are_refused(tmp_path: Path, scratch: Path) -> None:
    laughs = '<!DOCTYPE x [<!ENTITY a "ha"><!ENTITY b "&a;&a;">]><fmiModelDescription modelName="&b;"/>'
    message = refused(packed(tmp_path / "a.fmu", {"modelDescription.xml": laughs}), scratch)
    assert "has a document type declaration; entities are not accepted in an FMU" in message


def test_a_description_of_100_mb_is_refused_before_it_is_read(tmp_path: Path, scratch: Path) -> None:
    path = tmp_path / "a.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION + " " * 100_000_000)
    message = refused(path, scratch)
    assert message.startswith(f"modelDescription.xml: is larger than {xml_room.LARGEST // 2**20} MiB")


def test_malformed_deep_and_huge_xml(tmp_path: Path, scratch: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = packed(tmp_path / "a.fmu", {"modelDescription.xml": "<a>\n<b>"})
    assert refused(path, scratch).startswith("modelDescription.xml:2: is not well-formed XML")
    path = packed(tmp_path / "b.fmu", {"modelDescription.xml": "<a>" * 100})
    assert "nested more than 32 deep" in refused(path, scratch)
    monkeypatch.setattr(xml_room, "LARGEST", 100)
    with pytest.raises(FmuError, match="is larger than 0 MiB"):
        xml_room.parse_xml(DESCRIPTION.encode())


@pytest.mark.parametrize("version", ["1.1", "4.0"])
def test_another_version_of_fmi_says_which_is_supported(tmp_path: Path, scratch: Path, version: str) -> None:
    text = DESCRIPTION.replace('fmiVersion="2.0"', f'fmiVersion="{version}"')
    message = refused(packed(tmp_path / "a.fmu", {"modelDescription.xml": text}), scratch)
    assert message == (
        f"modelDescription.xml: the FMU is of another version of FMI (got '{version}'); allowed: 1.0, 2.0, 3.0"
    )  # fmt: skip


def test_a_missing_binary_lists_those_there_are(tmp_path: Path, scratch: Path) -> None:
    entries = {"modelDescription.xml": DESCRIPTION, "binaries/win64/m.dll": "x", "binaries/win32/m.dll": "x"}
    message = refused(packed(tmp_path / "pump.fmu", entries), scratch)
    assert "pump.fmu: has no binary for this platform: binaries/linux64/m.so (got 'win32, win64')" in message
    assert "allowed: linux64" in message


def test_a_library_that_does_not_load_leaves_nothing(tmp_path: Path, scratch: Path) -> None:
    entries = {"modelDescription.xml": DESCRIPTION, "binaries/linux64/m.so": "not a library"}
    path = packed(tmp_path / "a.fmu", entries)
    with pytest.raises(FmuError, match=r"a.fmu: its library cannot be loaded: m.so: .*It may be built for another"):
        fmi.Fmu(path)
    assert list(scratch.iterdir()) == []


def test_a_kind_that_the_fmu_does_not_have_says_so(tmp_path: Path, scratch: Path) -> None:
    path = packed(tmp_path / "a.fmu", {"modelDescription.xml": DESCRIPTION})
    with pytest.raises(FmuError, match=r"a.fmu: is not made for model-exchange; allowed: co-simulation"):
        fmi.Fmu(path, "model-exchange")
    text = DESCRIPTION.replace("CoSimulation", "ModelExchange")
    path = packed(tmp_path / "b.fmu", {"modelDescription.xml": text})
    with pytest.raises(FmuError, match=r"b.fmu: is not made for co-simulation; allowed: model-exchange"):
        fmi.Fmu(path, "co-simulation")


def test_all_problems_of_a_description_come_at_once(tmp_path: Path, scratch: Path) -> None:
    text = DESCRIPTION.replace('valueReference="0"', 'valueReference="zero" causality="inlet"').replace(
        "<Real/>", '<Real min="low"/>'
    )
    message = refused(packed(tmp_path / "a.fmu", {"modelDescription.xml": text}), scratch)
    assert "attribute 'valueReference' of <ScalarVariable> (got 'zero'); allowed: an integer" in message
    assert "attribute 'causality' of <ScalarVariable> (got 'inlet'); allowed: parameter, calculatedParameter" in message
    assert "attribute 'min' of <Real> (got 'low'); allowed: a number" in message


def test_the_private_folder_goes_with_the_fmu(piston_fmu: Path, scratch: Path) -> None:
    with fmi.Fmu(piston_fmu) as fmu:
        assert [p.name for p in scratch.iterdir()] == [fmu.folder.name]
        assert fmu.folder.stat().st_mode & 0o077 == 0
    assert list(scratch.iterdir()) == []
    forgotten = fmi.Fmu(piston_fmu)
    del forgotten
    assert list(scratch.iterdir()) == []


def test_a_description_with_no_end_of_problems_is_given_up(tmp_path: Path) -> None:
    head, _, tail = THREE.partition("<Float64")
    same = "".join(f'<Float64 name="x{i}" valueReference="{i // 2}" start="1"/>' for i in range(20_000))
    path = packed(tmp_path / "a.fmu", {"modelDescription.xml": f"{head}{same}<Float64{tail}"})
    problems = fmi.check(path)
    assert len(problems) == 201
    assert str(problems[-1]) == "modelDescription.xml: has more than 200 problems; these are the first"
    wrong = "".join('<Float64 name="x" valueReference="one"/>' for _ in range(20_000))
    path = packed(tmp_path / "b.fmu", {"modelDescription.xml": f"{head}{wrong}<Float64{tail}"}, zipfile.ZIP_STORED)
    with pytest.raises(FmuError, match="has more than 200 problems") as caught:
        fmi.read(path)
    assert len(caught.value.problems) == 201


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (TWO.replace("<Real/>", f'<Real {"b" * 1000}="1"/>'), "whose name is longer than 256 characters"),
        (TWO.replace("<Real/>", f'<Real min="{"l" * 100_000}"/>'), "attribute 'min' of <Real> (got 'lll"),
        (THREE.replace('start="1"', f'start="{"1 " * 1_000_001}"'), "attribute 'start' of <Float64> (got '1 1 1"),
        (THREE.replace("<Float64", '<Float64 derivative="99999999999999999999"', 1), "variable that does not exist"),
    ],
)
def test_what_a_hostile_description_is_full_of_is_refused_in_few_words(
    tmp_path: Path, scratch: Path, text: str, message: str
) -> None:
    said = refused(packed(tmp_path / "a.fmu", {"modelDescription.xml": text}, zipfile.ZIP_STORED), scratch)
    assert message in said
    assert len(said) < 1000


def test_a_description_of_too_many_parts_is_refused_before_it_fills_the_memory(
    tmp_path: Path, scratch: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(xml_room, "MOST_PARTS", 1000)
    path = packed(tmp_path / "a.fmu", {"modelDescription.xml": TWO.replace("<Real/>", "<Real/>" * 1001)})
    assert refused(path, scratch) == "modelDescription.xml:4: has more than 1000 elements and attributes"


def test_an_array_that_is_too_large_is_refused_and_a_large_one_is_no_signal(tmp_path: Path, scratch: Path) -> None:
    huge = THREE.replace('start="1"/>', '><Dimension start="99999999999"/></Float64>')
    assert "x: the array has 99999999999 elements; allowed: at most 10000000" in refused(
        packed(tmp_path / "a.fmu", {"modelDescription.xml": huge}), scratch
    )
    many = "".join(
        f'<Float64 name="a{i}" valueReference="{i + 9}"><Dimension start="4000"/></Float64>' for i in range(51)
    )
    slave = FmuSlave(
        packed(tmp_path / "b.fmu", {"modelDescription.xml": THREE.replace("<Float64", f"{many}<Float64", 1)})
    )
    assert len(slave.interface.watchable) == 200_000
    assert slave.interface.left_out["a50"] == "the FMU has more than 200000 signals before it"
