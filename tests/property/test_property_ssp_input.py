"""Whatever a system structure description holds, reading it gives a system or a `CosimError`, and nothing else."""

import re
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from seacrane.cosim import System, read_osp, read_ssp
from seacrane.errors import CosimError

SSD = """<SystemStructureDescription version="1.0" name="x">
<System name="root"><Connectors><Connector name="u" kind="input"><Real unit="N"/></Connector>
<Connector name="y" kind="output"/></Connectors>
<ParameterBindings><ParameterBinding prefix="a."><ParameterValues><ParameterSet version="1.0" name="p"><Parameters>
<Parameter name="k"><Real value="1.5" unit="N"/></Parameter></Parameters></ParameterSet></ParameterValues>
<ParameterMapping><ParameterMapping version="1.0"><MappingEntry source="a.k" target="u"/></ParameterMapping>
</ParameterMapping></ParameterBinding></ParameterBindings>
<Elements><System name="a"><Connectors><Connector name="u" kind="input"/>
<Connector name="y" kind="output"/></Connectors>
<Connections><Connection startConnector="u" endConnector="y"><LinearTransformation factor="2" offset="1"/></Connection>
</Connections></System><Component name="b" source="b.fmu"/>
<SignalDictionaryReference name="bus" dictionary="d"><Connectors><Connector name="s" kind="inout"/></Connectors>
</SignalDictionaryReference></Elements>
<Connections><Connection startConnector="u" endElement="a" endConnector="u"/>
<Connection startElement="a" startConnector="y" endElement="bus" endConnector="s"/>
<Connection startElement="bus" startConnector="s" endConnector="y" suppressUnitConversion="true"/></Connections>
<SignalDictionaries><SignalDictionary name="d"><SignalDictionary version="1.0"><DictionaryEntry name="s"><Real/>
</DictionaryEntry></SignalDictionary></SignalDictionary></SignalDictionaries></System>
<Units><Unit name="N"><BaseUnit kg="1" m="1" s="-2"/></Unit></Units><DefaultExperiment startTime="0" stopTime="1"/>
</SystemStructureDescription>"""

OSP = """<OspSystemStructure version="0.1"><StartTime>0</StartTime><BaseStepSize>0.1</BaseStepSize>
<Algorithm>fixedStep</Algorithm><Simulators><Simulator name="a" source="a.fmu" stepSize="0.1"><InitialValues>
<InitialValue variable="x"><Real value="1"/></InitialValue></InitialValues></Simulator></Simulators>
<Functions><Sum name="s" inputCount="2"/><VectorSum name="v" inputCount="1" dimension="3"/>
<LinearTransformation name="l" factor="1" offset="2"/></Functions>
<Connections><VariableConnection powerBond="p"><Variable simulator="a" name="x"/><Variable simulator="a" name="y"/>
</VariableConnection><SignalConnection><Variable simulator="a" name="x"/><Signal function="s" name="in[0]"/>
</SignalConnection><VariableGroupConnection><VariableGroup simulator="a" name="g"/>
<VariableGroup simulator="a" name="h"/></VariableGroupConnection></Connections></OspSystemStructure>"""


@st.composite
def mutilated(draw: st.DrawFn, text: str) -> str:
    """The text with pieces taken out, doubled, or replaced by others."""
    pieces = re.findall(r'<[^>]*>|"[^"]*"|[^<"]+', re.sub(r"\s+", " ", text))
    words = [*pieces, '""', '"-1"', '"1e999"', '"#root"', '"../x"', '"\x7f"', "<System>", "&lt;"]
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(pieces) - 1))
        quoted = [i for i, piece in enumerate(pieces) if '"' in piece]
        at = draw(st.sampled_from(quoted)) if draw(st.booleans()) and quoted else at
        new = draw(st.sampled_from(words))
        piece = pieces[at]
        inside = re.sub(r'"[^"]*"', lambda _, new=new: new if new[:1] == '"' else '"?"', piece, count=1)
        pieces[at : at + 1] = draw(st.sampled_from([[], [piece, piece], [new], [inside], [inside]]))
    return "".join(pieces)


@settings(max_examples=150, deadline=None)
@given(text=mutilated(SSD))
def test_a_mutilated_system_structure_description_is_a_system_or_an_error(tmp_path_factory, text: str) -> None:
    check(tmp_path_factory.getbasetemp() / "SystemStructure.ssd", text, read_ssp)


@settings(max_examples=150, deadline=None)
@given(text=mutilated(OSP))
def test_a_mutilated_osp_system_structure_is_a_system_or_an_error(tmp_path_factory, text: str) -> None:
    check(tmp_path_factory.getbasetemp() / "OspSystemStructure.xml", text, read_osp)


def check(path: Path, text: str, reader) -> None:
    path.write_bytes(text.encode())
    problems = []
    try:
        assert isinstance(reader(path), System)
    except CosimError as error:
        problems = [str(problem) for problem in error.problems] or [""]
    assert all(problems)
