"""Findings of the checker: each rule is broken once, and nothing else is found."""

import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu
from lessened import lessened

from seacrane import fmi

SOUND = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="tank" guid="g" variableNamingConvention="structured">
  <CoSimulation modelIdentifier="tank"/>
  <UnitDefinitions>
    <Unit name="m"><BaseUnit m="1"/><DisplayUnit name="mm" factor="1000"/></Unit>
  </UnitDefinitions>
  <TypeDefinitions><SimpleType name="Level"><Real unit="m"/></SimpleType></TypeDefinitions>
  <ModelVariables>
    <ScalarVariable name="inlet" valueReference="1" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="area" valueReference="2" causality="parameter" variability="fixed"><Real start="2" min="1" max="3"/></ScalarVariable>
    <ScalarVariable name="level" valueReference="3" causality="output" initial="exact"><Real declaredType="Level" displayUnit="mm" start="1"/></ScalarVariable>
    <ScalarVariable name="der(level)" valueReference="4"><Real derivative="3"/></ScalarVariable>
    <ScalarVariable name="full" valueReference="1" causality="output" variability="discrete"><Boolean/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="3" dependencies=""/><Unknown index="5" dependencies="3" dependenciesKind="dependent"/></Outputs>
    <Derivatives><Unknown index="4" dependencies="1"/></Derivatives>
    <InitialUnknowns><Unknown index="4"/><Unknown index="5"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""  # noqa: E501


LIBRARY = b"\x7fELF" + bytes(14) + b"\x3e\x00" + b"g"
"""What a library for this machine begins with, and the GUID."""


@pytest.fixture
def fmu_of(tmp_path: Path) -> Callable[..., Path]:
    def write(text: str, *binaries: str) -> Path:
        path = tmp_path / "tank.fmu"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", text)
            for name in binaries or ("binaries/linux64/tank.so",):
                archive.writestr(name, LIBRARY if name.endswith(".so") else "MZ")
        return path

    return write


def test_a_sound_description_has_no_findings(fmu_of: Callable[..., Path]) -> None:
    path = fmu_of(SOUND)
    assert fmi.check(path) == []
    assert validate_fmu(str(path)) == []


BROKEN = {
    "unique name": ('name="area"', 'name="inlet"', "inlet: is the name of 2 variables. FMI 2.0, section 2.2.7"),
    "naming": ('name="area"', 'name="area of tank"', "does not keep the structured naming convention"),
    "start of an input": ('<Real start="0"/>', "<Real/>", "inlet: has no start value"),
    "start of what is exact": ('displayUnit="mm" start="1"', 'displayUnit="mm"', "level: has no start value"),
    "start of what is calculated": (
        '<Real derivative="3"/>', '<Real derivative="3" start="1"/>',
        "der(level): is calculated and must not have a start value",
    ),
    "variability": ('variability="fixed"', 'variability="continuous"', "area: causality parameter does not go with"),
    "initial": ('causality="input"', 'causality="input" initial="exact"', "inlet: causality input and variability"),
    "continuous Boolean": (' variability="discrete"', "", "full: is Boolean, which cannot be continuous"),
    "unit": ('<Real start="0"/>', '<Real start="0" unit="kg"/>', "inlet: its unit is not defined (got 'kg')"),
    "display unit": ('displayUnit="mm"', 'displayUnit="km"', "level: its display unit is not defined for its unit"),
    "declared type": ('declaredType="Level"', 'declaredType="Depth"', "level: its declared type is not defined"),
    "range": ('min="1" max="3"', 'min="4" max="3"', "area: its minimum 4 is above its maximum 3"),
    "start in range": ('start="2" min', 'start="9" min', "area: its start value is out of its range (got 9.0)"),
    "outputs": ('<Unknown index="3" dependencies=""/>', "", "ModelStructure/Outputs: lacks level"),
    "derivatives": (' derivative="3"', "", "der(level): is listed as a derivative, but does not say of which"),
    "derivative of nothing": (
        'derivative="3"', 'derivative="30"', "der(level): is the derivative of a variable that does not exist",
    ),
    "initial unknowns": (
        '<InitialUnknowns><Unknown index="4"/>', '<InitialUnknowns><Unknown index="1"/><Unknown index="4"/>',
        "ModelStructure/InitialUnknowns: lists inlet",
    ),
    "index": ('<Unknown index="4"/>', '<Unknown index="44"/>', "lists a variable that does not exist (got 44)"),
    "dependency": ('dependencies="1"', 'dependencies="17"', "depends on variables that do not exist"),
    "kinds": ('dependenciesKind="dependent"', 'dependenciesKind="dependent fixed"', "not as many entries"),
    "order": (
        "<ModelStructure>\n    <Outputs>", "<ModelStructure>\n<InitialUnknowns/>    <Outputs>",
        "<Outputs> stands after <InitialUnknowns>",
    ),
    "attribute": ('guid="g"', 'guid="g" gid="g"', "has an unknown attribute 'gid'. Did you mean 'guid'?"),
    "missing attribute": (' guid="g"', "", "<fmiModelDescription> lacks the attribute 'guid'"),
    "element": ("<ModelStructure>", "<ModelStructure><Extra/>", "<Extra> does not belong into <ModelStructure>"),
    "alias": ('valueReference="2"', 'valueReference="1"', "inlet, area: share a value reference, and more than one"),
    "nothing to run": (
        '<CoSimulation modelIdentifier="tank"/>', "", "has neither <CoSimulation> nor <ModelExchange>",
    ),
}  # fmt: skip


@pytest.mark.parametrize("rule", BROKEN)
def test_a_broken_rule_is_found(rule: str, fmu_of: Callable[..., Path]) -> None:
    old, new, expected = BROKEN[rule]
    assert old in SOUND
    found = [str(p) for p in fmi.check(fmu_of(SOUND.replace(old, new, 1)))]
    assert any(expected in text for text in found), found


def test_whatever_is_taken_away_we_find_what_another_validator_finds(fmu_of: Callable[..., Path]) -> None:
    missed = []
    for missing, text in lessened(SOUND):
        path = fmu_of(text)
        if validate_fmu(str(path)) and not fmi.check(path):
            missed.append(missing)
    assert missed == []


def test_a_binary_is_looked_for(fmu_of: Callable[..., Path]) -> None:
    (found,) = fmi.check(fmu_of(SOUND, "binaries/win64/tank.dll"))
    assert str(found).startswith("binaries: there is no binaries/linux64/tank.so, so the FMU does not run here")
    (found,) = fmi.check(fmu_of(SOUND, "documentation/index.html"))
    assert found.message == "there is neither a binary nor a source file"
