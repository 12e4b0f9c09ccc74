"""Findings of the checker in FMI 3.0: each rule is broken once, and nothing else is found."""

import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu
from lessened import lessened

from seacrane import fmi
from seacrane.errors import FmuError

SOUND = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="tank" instantiationToken="g" variableNamingConvention="structured">
  <ModelExchange modelIdentifier="tank" needsCompletedIntegratorStep="true"/>
  <CoSimulation modelIdentifier="tank" hasEventMode="true" mightReturnEarlyFromDoStep="true"/>
  <UnitDefinitions>
    <Unit name="m"><BaseUnit m="1"/><DisplayUnit name="mm" factor="1000"/></Unit>
  </UnitDefinitions>
  <TypeDefinitions>
    <Float64Type name="Level" unit="m"/>
    <EnumerationType name="Mode"><Item name="off" value="0"/><Item name="on" value="1"/></EnumerationType>
  </TypeDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent"/>
    <Float64 name="inlet" valueReference="1" causality="input" start="0"/>
    <UInt64 name="n" valueReference="2" causality="structuralParameter" start="3"/>
    <Float64 name="area" valueReference="3" causality="parameter" start="2 2.5 3" min="1" max="3">
      <Dimension valueReference="2"/>
    </Float64>
    <Float64 name="level" valueReference="4" causality="output" initial="exact" declaredType="Level" displayUnit="mm" start="1">
      <Alias name="depth" displayUnit="mm"/>
    </Float64>
    <Float64 name="der(level)" valueReference="5" derivative="4"/>
    <Boolean name="full" valueReference="6" causality="output"/>
    <String name="label" valueReference="7" causality="parameter"><Start value="tank"/></String>
    <Binary name="blob" valueReference="8" causality="parameter"><Start value="00ff"/></Binary>
    <Enumeration name="mode" valueReference="9" causality="parameter" declaredType="Mode" start="1"/>
    <Int8 name="small" valueReference="10" causality="parameter" start="-128"/>
    <Float32 name="grid" valueReference="11" causality="output"><Dimension start="2"/><Dimension start="3"/></Float32>
    <Clock name="tick" valueReference="12" causality="local" intervalVariability="triggered"/>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference="4" dependencies=""/>
    <Output valueReference="6" dependencies="4" dependenciesKind="dependent"/>
    <Output valueReference="11"/>
    <ContinuousStateDerivative valueReference="5" dependencies="1"/>
    <InitialUnknown valueReference="5"/>
    <InitialUnknown valueReference="6"/>
    <InitialUnknown valueReference="11"/>
    <EventIndicator valueReference="5"/>
  </ModelStructure>
</fmiModelDescription>
"""  # noqa: E501

TERMINALS = """<fmiTerminalsAndIcons fmiVersion="3.0"><Terminals>
  <Terminal name="pipe" matchingRule="bond" terminalKind="hydraulic" description="inlet pipe">
    <TerminalMemberVariable variableName="inlet" memberName="flow" variableKind="signal"/>
    <TerminalMemberVariable variableName="level" variableKind="signal"/>
  </Terminal></Terminals></fmiTerminalsAndIcons>
"""


LIBRARY = b"\x7fELF" + bytes(14) + b"\x3e\x00" + b"g"
"""What a library for this machine begins with, and the GUID."""


@pytest.fixture
def fmu_of(tmp_path: Path) -> Callable[..., Path]:
    def write(text: str, *binaries: str, terminals: str = TERMINALS) -> Path:
        path = tmp_path / "tank.fmu"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", text)
            archive.writestr("terminalsAndIcons/terminalsAndIcons.xml", terminals)
            for name in binaries or ("binaries/x86_64-linux/tank.so",):
                archive.writestr(name, LIBRARY if name.endswith(".so") else "MZ")
        return path

    return write


def test_a_sound_description_has_no_findings(fmu_of: Callable[..., Path]) -> None:
    path = fmu_of(SOUND)
    assert fmi.check(path) == []
    assert validate_fmu(str(path)) == []


def test_types_shapes_start_values_and_references_are_read(fmu_of: Callable[..., Path]) -> None:
    d = fmi.read(fmu_of(SOUND))
    v = d.by_name
    assert d.fmi_version == "3.0"
    assert (v["area"].shape, v["area"].start) == ((3,), (2.0, 2.5, 3.0))
    assert (v["grid"].shape, v["grid"].count) == ((2, 3), 6)
    assert (v["blob"].start, v["label"].start, v["mode"].start, v["small"].start) == (b"\x00\xff", "tank", 1, -128)
    assert (v["depth"].alias_of, v["depth"].value_reference) == ("level", 4)
    assert d.variables[v["der(level)"].derivative - 1].name == "level"
    assert [d.variables[u.index - 1].name for u in d.outputs] == ["level", "full", "grid"]
    assert (v["inlet"].initial, v["n"].variability, v["full"].variability) == ("exact", "fixed", "discrete")
    assert (d.co_simulation.event_mode, d.co_simulation.returns_early, d.event_indicators) == (True, True, 1)
    assert d.terminals[0].members == {"flow": "inlet", "level": "level"}


BROKEN = {
    "unique name": ('name="label"', 'name="inlet"', "inlet: is the name of 2 variables. FMI 3.0, section 2.4.7"),
    "naming": ('name="label"', 'name="label of tank"', "does not keep the structured naming convention"),
    "start of an input": ('causality="input" start="0"', 'causality="input"', "inlet: has no start value"),
    "start of what is calculated": (
        'derivative="4"/>', 'derivative="4" start="1"/>', "der(level): is calculated and must not have a start value",
    ),
    "variability": ('parameter" start="-128"', 'parameter" variability="continuous" start="1"', "small: causality"),
    "continuous Boolean": ('causality="output"/>\n    <String', 'causality="output" variability="continuous"/><String',
                           "full: is Boolean, which cannot be continuous"),
    "unit": ('causality="input" start="0"', 'causality="input" start="0" unit="kg"', "inlet: its unit is not defined"),
    "display unit": ('declaredType="Level" displayUnit="mm"', 'declaredType="Level" displayUnit="km"',
                     "level: its display unit is not defined"),
    "declared type": ('declaredType="Mode"', 'declaredType="Moods"', "mode: its declared type is not defined"),
    "independent": ('causality="independent"', "", "ModelVariables: there must be an independent variable"),
    "value reference": ('valueReference="10"', 'valueReference="9"', "mode, small: share a value reference"),
    "outputs": ('<Output valueReference="4" dependencies=""/>', "", "ModelStructure/Outputs: lacks level"),
    "initial unknowns": ('<InitialUnknown valueReference="6"/>', "", "ModelStructure/InitialUnknowns: lacks full"),
    "unknown": ('<InitialUnknown valueReference="6"/>', '<InitialUnknown valueReference="66"/>',
                "<InitialUnknown> has value references of no variable (got [66])"),
    "dependency": ('dependencies="1"', 'dependencies="17"', "has value references of no variable (got [17])"),
    "kinds": ('dependenciesKind="dependent"', 'dependenciesKind="dependent fixed"', "not as many entries"),
    "derivative": ('derivative="4"', 'derivative="44"', "is the derivative of a variable that does not exist (got 44)"),
    "dimension": ('<Dimension valueReference="2"/>', '<Dimension valueReference="1"/>', "refers to no structural"),
    "both of a dimension": ('<Dimension start="2"/>', '<Dimension start="2" valueReference="2"/>', "needs one of"),
    "huge array": ('<Dimension start="2"/>', '<Dimension start="99999999999"/>', "the array has 299999999997 elements"),
    "start values": ('start="2 2.5 3"', 'start="2 3"', "area: has 2 start values; allowed: 1 or 3"),
    "integer range": ('start="-128"', 'start="-129"', "attribute 'start' of <Int8> (got '-129')"),
    "binary": ('value="00ff"', 'value="0xff"', "start value of a <Binary> (got '0xff'); allowed: hexadecimal digits"),
    "type": ("<Int8 ", "<Int7 ", "<Int7> is no type of variable"),
    "token": ('instantiationToken="g"', 'instantiationToken=""', "the instantiationToken is empty"),
    "attribute": ('hasEventMode="true"', 'hasEventModes="true"', "has an unknown attribute 'hasEventModes'. Did you"),
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


def test_a_terminal_with_a_variable_that_does_not_exist_is_found(fmu_of: Callable[..., Path]) -> None:
    path = fmu_of(SOUND, terminals=TERMINALS.replace('"inlet"', '"intel"'))
    (found,) = fmi.check(path)
    assert str(found) == "terminalsAndIcons/terminalsAndIcons.xml:3: there is no such variable (got 'intel')"
    with pytest.raises(FmuError, match="there is no such variable"):
        fmi.read(path)


def test_a_binary_is_looked_for_where_fmi_3_has_it(fmu_of: Callable[..., Path]) -> None:
    (found,) = fmi.check(fmu_of(SOUND, "binaries/linux64/tank.so"))
    assert str(found).startswith("binaries: there is no binaries/x86_64-linux/tank.so, so the FMU does not run here")
