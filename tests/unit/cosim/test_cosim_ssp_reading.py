"""Foreign SSPs: what the standard says of them is done, and what is wrong with them is told all at once."""

import zipfile
from pathlib import Path

import pytest

from seacrane.cosim import Connection, Execution, FmuSlave, Jacobi, System, load, read_ssp, write_ssp
from seacrane.cosim.ssp.schema import SPACES
from seacrane.errors import CosimError

HEAD = "".join(f' xmlns:{prefix}="{space}"' for prefix, space in SPACES.items())
UNITS = """<ssd:Units>
  <ssc:Unit name="Newton"><ssc:BaseUnit kg="1" m="1" s="-2"/></ssc:Unit>
  <ssc:Unit name="kN"><ssc:BaseUnit kg="1" m="1" s="-2" factor="1000"/></ssc:Unit>
  <ssc:Unit name="tonne"><ssc:BaseUnit kg="1" factor="1000"/></ssc:Unit>
</ssd:Units>"""


def document(system: str, version: str = "1.0", more: str = UNITS) -> str:
    tag = "ssd:SystemStructureDescription"
    return f'<{tag}{HEAD} version="{version}" name="doc">{system}{more}</{tag}>'


def parameter_set(values: str, more: str = "") -> str:
    inside = f"<ssv:Parameters>{values}</ssv:Parameters>{more}"
    return f'<ssv:ParameterSet{HEAD} version="1.0" name="set">{inside}</ssv:ParameterSet>'


def real(name: str, value: float, unit: str = "") -> str:
    unit = unit and f' unit="{unit}"'
    return f'<ssv:Parameter name="{name}"><ssv:Real value="{value}"{unit}/></ssv:Parameter>'


def binding(values: str = "", mapping: str = "", attributes: str = "") -> str:
    values = values and f"<ssd:ParameterValues>{parameter_set(values)}</ssd:ParameterValues>"
    return (
        f"<ssd:ParameterBindings><ssd:ParameterBinding {attributes}>{values}{mapping}"
        "</ssd:ParameterBinding></ssd:ParameterBindings>"
    )


def component(name: str, source: str, inside: str = "", attributes: str = "") -> str:
    return f'<ssd:Component name="{name}" source="{source}" {attributes}>{inside}</ssd:Component>'


def connectors(*entries: str) -> str:
    """Each `kind name`, or `kind name unit`."""
    found = []
    for entry in entries:
        kind, name, *unit = entry.split(" ")
        held = f'<ssc:Real unit="{unit[0]}"/>' if unit else ""
        found.append(f'<ssd:Connector name="{name}" kind="{kind}">{held}</ssd:Connector>')
    return f"<ssd:Connectors>{''.join(found)}</ssd:Connectors>"


def link(start: str, end: str, inside: str = "", attributes: str = "") -> str:
    """Ends are `element.connector`, or `connector` of the system itself."""
    ends = []
    for which, name in (("start", start), ("end", end)):
        element, dot, connector = name.partition(".")
        ends.append(
            f'{which}Element="{element}" {which}Connector="{connector}"' if dot else f'{which}Connector="{name}"'
        )
    return f"<ssd:Connection {' '.join(ends)} {attributes}>{inside}</ssd:Connection>"


def system(elements: str, links: str = "", before: str = "", after: str = "", name: str = "root", attributes="") -> str:
    return (
        f'<ssd:System name="{name}" {attributes}>{before}<ssd:Elements>{elements}</ssd:Elements>'
        f"{links and f'<ssd:Connections>{links}</ssd:Connections>'}{after}</ssd:System>"
    )


@pytest.fixture
def folder(coupled_fmus: Path, tmp_path: Path) -> Path:
    for name in ("spring", "mass", "mixer"):
        (tmp_path / f"{name}.fmu").symlink_to(coupled_fmus / f"{name}.fmu")
    return tmp_path


def written(folder: Path, text: str) -> Path:
    """An archive with this description and all other files of the folder."""
    path = folder.parent / f"{folder.name}.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        for file in sorted(folder.iterdir()):
            archive.write(file, file.name)
        archive.writestr("SystemStructure.ssd", text)
    return path


def read(folder: Path, text: str, versions=("1.0", "2.0")) -> System:
    """The system of a description; written and read again, it is the same."""
    found = read_ssp(written(folder, text))
    for version in versions:
        again = read_ssp(write_ssp(found, folder.parent / "again.ssp", version=version))
        assert set(again.connections) == set(found.connections)
        assert {name: parameters(again, name) for name in again.slaves} == {
            name: parameters(found, name) for name in found.slaves
        }
        assert again.open_inputs == found.open_inputs
    return found


def parameters(found: System, slave: str) -> dict:
    part = found.slaves[slave]
    assert isinstance(part, FmuSlave)
    return part.parameters


def problems(folder: Path, text: str) -> list[str]:
    with pytest.raises(CosimError) as caught:
        read(folder, text)
    return [str(problem) for problem in caught.value.problems]


PAIR = component("spring", "spring.fmu") + component("mass", "mass.fmu")
LOOP = link("spring.force", "mass.force") + link("mass.velocity", "spring.velocity")


# ---------------------------------------------------------------- connections
def test_start_and_end_of_a_connection_do_not_say_its_direction(folder: Path) -> None:
    found = read(
        folder, document(system(PAIR, link("mass.force", "spring.force") + link("spring.velocity", "mass.velocity")))
    )
    assert set(found.connections) == {
        Connection("spring.force", "mass.force"), Connection("mass.velocity", "spring.velocity"),
    }  # fmt: skip
    with Execution(found, Jacobi(0.01)) as run:
        run.step(10)
        assert run.values(["mass.velocity"])[0] > 0.1


def test_a_linear_transformation_comes_after_the_conversion_of_units(folder: Path) -> None:
    scale = '<ssc:LinearTransformation factor="2" offset="0.5"/>'
    found = read(folder, document(system(PAIR, link("spring.force", "mass.pull", scale))))
    assert found.connections == (Connection("spring.force", "mass.pull", 2.0, 0.5),)
    raw = link("spring.force", "mass.pull", scale, 'suppressUnitConversion="true"')
    assert read(folder, document(system(PAIR, raw))).connections == (
        Connection("spring.force", "mass.pull", 2.0, 0.5, convert=False),
    )


def test_a_unit_that_a_connector_states_counts_and_one_that_nothing_states_converts_nothing(folder: Path) -> None:
    mixers = "".join(component(n, "mixer.fmu", connectors(*c)) for n, c in (
        ("a", ["output force_out Newton"]), ("b", ["input force kN"]), ("c", ["input plain"]),
    ))  # fmt: skip
    found = read(folder, document(system(mixers, link("a.force_out", "b.force") + link("a.force_out", "c.plain"))))
    assert found.connections == (
        Connection("a.force_out", "b.force", 1e-3, convert=False),
        Connection("a.force_out", "c.plain", convert=False),
    )


def test_systems_nest_and_their_connectors_pass_on(folder: Path) -> None:
    inner = system(
        component("m 1", "mass.fmu"), link("pull", "m 1.force") + link("m 1.velocity", "v"),
        connectors("input pull kN", "output v"), name="the.inner one",
    )  # fmt: skip
    found = read(folder, document(system(component("spring", "spring.fmu") + inner)))
    assert list(found.slaves) == ["spring", "the_inner_one.m_1"]
    part = found.level.parts["the_inner_one"]
    assert isinstance(part, System)
    assert {c.name: (c.kind, c.unit) for c in part.level.connectors.values()} == {
        "pull": ("input", "kN"), "v": ("output", ""),
    }  # fmt: skip
    assert part.unit_of("v") == "m/s"


def test_an_ssd_an_ssp_and_a_system_of_the_same_document_can_be_components(folder: Path) -> None:
    half = document(system(component("m", "mass.fmu"), link("f", "m.force"), connectors("input f"), name="half"))
    (folder / "half.ssd").write_text(half)
    with zipfile.ZipFile(folder / "half.ssp", "w") as archive:
        archive.write(folder / "mass.fmu", "mass.fmu")
        archive.writestr("SystemStructure.ssd", half.replace('name="m"', 'name="default"').replace('"m"', '"default"'))
        archive.writestr("variant.ssd", half.replace('name="m"', 'name="other"').replace('"m"', '"other"'))
    elements = (
        component("spring", "spring.fmu")
        + component("a", "half.ssd", attributes='type="application/x-ssp-definition"')
        + component("b", "half.ssp", attributes='type="application/x-ssp-package"')
        + component("c", "half.ssp#variant.ssd", attributes='type="application/x-ssp-package"')
        + system(component("m", "mass.fmu"), link("f", "m.force"), connectors("input f"), name="d", attributes='id="D"')
        + component("e", "#D", binding(real("m.weight", 3.0)))
    )
    found = read(folder, document(system(elements, "".join(link("spring.force", f"{n}.f") for n in "abcde"))))
    assert {c.target for c in found.connections} == {
        "a.m.force", "b.default.force", "c.other.force", "d.m.force", "e.m.force",
    }  # fmt: skip
    assert (parameters(found, "d.m"), parameters(found, "e.m")) == ({}, {"weight": 3.0})
    with Execution(found, Jacobi(0.01)) as run:
        run.step(3)


# ---------------------------------------------------------------- parameters
def test_parameters_are_converted_and_what_no_component_has_is_passed_over(folder: Path) -> None:
    values = real("mass", 3, "tonne") + real("weight", 5) + real("nothing", 1) + real("force", 2.5, "kN")
    found = read(folder, document(system(component("m", "mass.fmu", binding(values)))))
    assert parameters(found, "m") == {"mass": 3000.0, "weight": 5.0, "force": 2500.0}


def test_the_higher_level_wins_and_on_one_level_the_later(folder: Path) -> None:
    own = binding(real("mass", 1) + real("weight", 1))
    both = binding(real("m.mass", 2)).replace("</ssd:ParameterBindings>", "") + binding(real("m.mass", 3)).replace(
        "<ssd:ParameterBindings>", ""
    )
    inner = system(component("m", "mass.fmu", own), name="sub", before=both)
    assert parameters(read(folder, document(system(inner))), "sub.m") == {"mass": 3.0, "weight": 1.0}
    outer = read(folder, document(system(inner, before=binding(real("sub.m.mass", 4)))))
    assert parameters(outer, "sub.m") == {"mass": 4.0, "weight": 1.0}
    prefixed = read(folder, document(system(inner, before=binding(real("mass", 5), attributes='prefix="sub.m."'))))
    assert parameters(prefixed, "sub.m") == {"mass": 5.0, "weight": 1.0}


def test_a_parameter_of_a_system_reaches_what_its_connector_leads_to(folder: Path) -> None:
    scale = '<ssc:LinearTransformation factor="10" offset="1"/>'
    inner = system(
        component("m", "mass.fmu"), link("load", "m.mass", scale), connectors("parameter load tonne"), name="sub"
    )
    found = read(folder, document(system(inner, before=binding(real("sub.load", 0.02, "tonne")))))
    assert parameters(found, "sub.m") == {"mass": 201.0}


def test_files_of_values_and_mappings_are_read(folder: Path) -> None:
    (folder / "set.ssv").write_text(
        parameter_set(
            real("load", 2, "t") + real("weight", 7)
            + '<ssv:Parameter name="size"><ssv:Integer value="40"/></ssv:Parameter>'
            + '<ssv:Parameter name="on"><ssv:Boolean value="true"/></ssv:Parameter>'
            + '<ssv:Parameter name="grade"><ssv:Enumeration value="hard" name="Grade"/></ssv:Parameter>',
            '<ssv:Enumerations><ssc:Enumeration name="Grade"><ssc:Item name="soft" value="1"/>'
            '<ssc:Item name="hard" value="2"/></ssc:Enumeration></ssv:Enumerations>'
            '<ssv:Units><ssc:Unit name="t"><ssc:BaseUnit kg="1" factor="1000"/></ssc:Unit></ssv:Units>',
        )
    )  # fmt: skip
    (folder / "map.ssm").write_text(
        f'<ssm:ParameterMapping{HEAD} version="1.0">'
        '<ssm:MappingEntry source="load" target="m.mass"><ssc:LinearTransformation factor="0.5" offset="3"/>'
        '</ssm:MappingEntry><ssm:MappingEntry source="size" target="m.weight"><ssc:IntegerMappingTransformation>'
        '<ssc:MapEntry source="40" target="44"/></ssc:IntegerMappingTransformation></ssm:MappingEntry>'
        '<ssm:MappingEntry source="grade" target="m.force"/><ssm:MappingEntry source="on" target="m.pull"/>'
        "</ssm:ParameterMapping>"
    )
    mapping = '<ssd:ParameterMapping source="map.ssm"/>'
    found = read(
        folder,
        document(system(component("m", "mass.fmu"), before=binding(mapping=mapping, attributes='source="set.ssv"'))),
    )
    assert parameters(found, "m") == {"mass": 1003.0, "weight": 44.0, "force": 2.0, "pull": 1.0}


def test_a_parameter_out_of_its_bounds_or_in_a_wrong_unit_is_refused(folder: Path) -> None:
    found = problems(folder, document(system(component("m", "mass.fmu", binding(real("mass", 0))))))
    assert found == ["SystemStructure.ssd:1: m.mass: is out of its bounds (got 0.0); allowed: 0.1 to inf kg"]
    found = problems(folder, document(system(component("m", "mass.fmu", binding(real("mass", 1, "Newton"))))))
    assert found == ["SystemStructure.ssd:1: m.mass: is in 'kg' and cannot take a value in 'N'"]


def test_values_that_lie_in_the_component_are_read_from_there(folder: Path) -> None:
    with zipfile.ZipFile(folder / "mass.fmu") as archive:
        content = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(folder / "own.fmu", "w") as archive:
        for name, data in {**content, "resources/heavy.ssv": parameter_set(real("mass", 9)).encode()}.items():
            archive.writestr(name, data)
    inside = binding(attributes='source="resources/heavy.ssv" sourceBase="component"')
    assert parameters(read(folder, document(system(component("m", "own.fmu", inside)))), "m") == {"mass": 9.0}
    gone = binding(attributes='source="resources/gone.ssv" sourceBase="component"')
    assert problems(folder, document(system(component("m", "own.fmu", gone)))) == [
        "SystemStructure.ssd:1: is not in 'own.fmu' (got 'resources/gone.ssv')"
    ]


# ---------------------------------------------------------------- signal dictionaries
DICTIONARY = (
    f'<ssb:SignalDictionary{HEAD} version="1.0">'
    '<ssb:DictionaryEntry name="F"><ssc:Real unit="kN"/></ssb:DictionaryEntry>'
    '<ssb:DictionaryEntry name="v"><ssc:Real/></ssb:DictionaryEntry><ssb:Units><ssc:Unit name="kN">'
    '<ssc:BaseUnit kg="1" m="1" s="-2" factor="1000"/></ssc:Unit></ssb:Units></ssb:SignalDictionary>'
)
REFERENCE = '<ssd:SignalDictionaryReference name="bus" dictionary="can">' + connectors("inout F", "inout v")
REFERENCE += "</ssd:SignalDictionaryReference>"


@pytest.mark.parametrize("inline", [True, False])
def test_a_signal_dictionary_is_a_bus_through_all_levels_below_it(folder: Path, inline: bool) -> None:
    (folder / "can.ssb").write_text(DICTIONARY)
    holder = (
        f'<ssd:SignalDictionary name="can">{DICTIONARY}</ssd:SignalDictionary>'
        if inline
        else '<ssd:SignalDictionary name="can" source="can.ssb"/>'
    )
    half = system(
        component("m", "mass.fmu") + REFERENCE, link("bus.F", "m.force") + link("m.velocity", "bus.v"), name="x"
    )
    deep = system(half, name="deep")
    top = system(
        component("spring", "spring.fmu") + REFERENCE + deep,
        link("spring.force", "bus.F") + link("bus.v", "spring.velocity"),
        after=f"<ssd:SignalDictionaries>{holder}</ssd:SignalDictionaries>",
    )
    found = read(folder, document(top))
    pairs = {(c.source, c.target) for c in found.connections}
    assert pairs == {("spring.force", "deep.x.m.force"), ("deep.x.m.velocity", "spring.velocity")}
    with Execution(found, Jacobi(0.01)) as run:
        run.step(20)
        force, felt = run.values(["spring.force", "deep.x.m.force"])
        assert force < -0.1
        assert felt == pytest.approx(force, rel=0.2)


def test_a_system_that_is_used_twice_has_the_dictionary_of_each_place(folder: Path) -> None:
    holder = f'<ssd:SignalDictionaries><ssd:SignalDictionary name="can">{DICTIONARY}</ssd:SignalDictionary>'
    half = system(component("m", "mass.fmu") + REFERENCE, link("bus.F", "m.force"), name="x", attributes='id="X"')
    top = system(
        component("spring", "spring.fmu") + REFERENCE + half + component("y", "#X"),
        link("spring.force", "bus.F"),
        after=f"{holder}</ssd:SignalDictionaries>",
    )
    assert {c.target for c in read(folder, document(top)).connections} == {"x.m.force", "y.m.force"}


def test_what_is_wrong_with_a_dictionary_is_told(folder: Path) -> None:
    top = system(component("spring", "spring.fmu") + REFERENCE, link("spring.force", "bus.F"))
    assert problems(folder, document(top)) == ["SystemStructure.ssd:1: there is no signal dictionary 'can'"]


# ---------------------------------------------------------------- what is wrong
def test_everything_that_is_wrong_is_told_at_once(folder: Path) -> None:
    elements = (
        PAIR
        + component("spring", "spring.fmu")
        + component("gone", "gone.fmu")
        + component("away", "../../etc/passwd")
        + component("net", "http://example.org/x.fmu")
        + component("odd", "spring.fmu", attributes='type="application/x-other"')
        + component("mixer", "mixer.fmu", connectors("input forze", "output force", "input speed kN"))
    )
    links = (
        LOOP
        + link("mixer.force_out", "mass.force")
        + link("spring.force", "mass.velocity")
        + link("spring.velocity", "mass.force")
        + link("sprong.force", "mass.pull")
        + link("gone.x", "mass.pull")
        + link("mass.velocity", "mixer.force")
    )
    found = problems(
        folder,
        document(system(elements, links))
        .replace("<ssd:Comp", "\n<ssd:Comp")
        .replace("<ssd:Connection ", "\n<ssd:Connection "),
    )
    assert found == [
        "SystemStructure.ssd:4: there is an element 'spring' already (got 'spring')",
        "SystemStructure.ssd:5: gone: is not there (got 'gone.fmu')",
        "SystemStructure.ssd:6: away: leads out of the folder of the system structure (got '../../etc/passwd')",
        "SystemStructure.ssd:7: net: is no file of the system structure (got 'http://example.org/x.fmu'); "
        "allowed: a relative path",
        "SystemStructure.ssd:8: is a component of a type that does not run here: application/x-other; "
        "allowed: application/x-fmu-sharedlibrary, application/x-ssp-package",
        "SystemStructure.ssd:9: 'mixer' has no variable 'forze'. Did you mean 'force' or 'force_out'?",
        "SystemStructure.ssd:9: connector 'force' of 'mixer' is of kind 'output', "
        "and its variable is of causality 'input'",
        "SystemStructure.ssd:9: connector 'speed' of 'mixer' is in 'kN', and its variable in 'm/s'",
        "SystemStructure.ssd:15: there is no element 'sprong'. Did you mean 'spring'?",
        "mass.force: is driven by 'spring.force' already (got 'mixer.force_out')",
        "mass.velocity: is an output variable; a connection must end at an input. "
        "Did you mean 'mass.force' or 'mass.pull'?",
        "spring.velocity: is an input variable; a connection must start at an output. Did you mean 'spring.force'?",
        "mass.force: is driven by 'spring.force' already (got 'spring.velocity')",
        "mixer.force: is in 'N' and cannot take 'mass.velocity', which is in 'm/s'",
    ]


def model_description(kind: str, name: str) -> str:
    variability = "continuous" if kind == "Real" else "discrete"
    head = f'<ScalarVariable variability="{variability}"'
    variables = (
        f'{head} name="u" valueReference="0" causality="input"><{kind} start="0"/></ScalarVariable>'
        f'{head} name="y" valueReference="1" causality="output"><{kind}/></ScalarVariable>'
    )
    return (
        f'<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="1"><CoSimulation modelIdentifier="{name}"/>'
        f'<ModelVariables>{variables}</ModelVariables><ModelStructure><Outputs><Unknown index="2"/></Outputs>'
        "</ModelStructure></fmiModelDescription>"
    )


def test_a_number_of_a_wider_type_does_not_go_into_a_narrower_one(tmp_path: Path) -> None:
    for kind in ("Real", "Integer", "Boolean"):
        with zipfile.ZipFile(tmp_path / f"{kind}.fmu", "w") as archive:
            archive.writestr("modelDescription.xml", model_description(kind, kind))
    elements = "".join(component(kind, f"{kind}.fmu") for kind in ("Real", "Integer", "Boolean"))
    widening = link("Boolean.y", "Integer.u") + link("Integer.y", "Real.u")
    assert len(read(tmp_path, document(system(elements, widening))).connections) == 2
    narrowing = link("Real.y", "Integer.u") + link("Integer.y", "Boolean.u")
    assert problems(tmp_path, document(system(elements, narrowing))) == [
        "Integer.u: is of type Integer and cannot take 'Real.y', which is of type Real",
        "Boolean.u: is of type Boolean and cannot take 'Integer.y', which is of type Integer",
    ]
    wrong = component(
        "x", "Real.fmu", connectors("input u").replace("></ssd:Connector", "><ssc:Boolean/></ssd:Connector")
    )
    assert problems(tmp_path, document(system(wrong))) == [
        "SystemStructure.ssd:1: connector 'u' of 'x' is of type Boolean, and its variable of Real"
    ]


def test_a_type_is_held_through_connectors_too(tmp_path: Path) -> None:
    for kind in ("Real", "Integer"):
        with zipfile.ZipFile(tmp_path / f"{kind}.fmu", "w") as archive:
            archive.writestr("modelDescription.xml", model_description(kind, kind))
    inner = system(component("i", "Integer.fmu"), link("u", "i.u"), connectors("input u"), name="sub")
    found = problems(tmp_path, document(system(component("r", "Real.fmu") + inner, link("r.y", "sub.u"))))
    assert found == ["sub.i.u: is of type Integer and cannot take 'r.y', which is of type Real"]


def test_arrays_are_connected_element_by_element(tmp_path: Path) -> None:
    for name, size in (("two", 2), ("three", 3)):
        head = '<Float64 variability="continuous" name="%s" valueReference="%d" causality="%s"%s>'
        head += f'<Dimension start="{size}"/>'
        start = f' start="{" ".join(["0"] * size)}"'
        variables = head % ("u", 1, "input", start) + "</Float64>" + head % ("y", 2, "output", "") + "</Float64>"
        with zipfile.ZipFile(tmp_path / f"{name}.fmu", "w") as archive:
            archive.writestr(
                "modelDescription.xml",
                f'<fmiModelDescription fmiVersion="3.0" modelName="{name}" instantiationToken="1">'
                f'<CoSimulation modelIdentifier="{name}"/><ModelVariables>{variables}</ModelVariables>'
                '<ModelStructure><Output valueReference="2"/></ModelStructure></fmiModelDescription>',
            )
    elements = component("a", "two.fmu") + component("b", "two.fmu") + component("c", "three.fmu")
    found = read(tmp_path, document(system(elements, link("a.y", "b.u")), "2.0"), ["2.0"])
    assert found.connections == (Connection("a.y[1]", "b.u[1]"), Connection("a.y[2]", "b.u[2]"))
    one = link("c.u", "a.y", attributes='startIndices="3" endIndices="1"')
    assert read(tmp_path, document(system(elements, one), "2.0"), ["2.0"]).connections == (
        Connection("a.y[1]", "c.u[3]"),
    )
    with pytest.raises(CosimError, match=r"a.y\[1\]: is an element of an array. Write SSP 2.0."):
        write_ssp(found, tmp_path / "no.ssp", version="1.0")
    with zipfile.ZipFile(write_ssp(found, tmp_path / "yes.ssp", version="2.0")) as archive:
        assert '<ssc:Dimension size="2" />' in archive.read("SystemStructure.ssd").decode()
    assert problems(tmp_path, document(system(elements, link("a.y", "c.u")))) == [
        "SystemStructure.ssd:1: connects 'a.y' and 'c.u', which have different shapes (got [2, 3])"
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<ssd:System", "SystemStructure.ssd:1: is not well-formed XML: unclosed token"),
        ("<!DOCTYPE x [<!ENTITY a 'b'>]><x/>", "SystemStructure.ssd:1: has a document type declaration"),
        ("<x/>", "SystemStructure.ssd: the root element is <x>; allowed: <SystemStructureDescription>"),
        (document("", "3.0"), "SystemStructure.ssd:1: is of another version of SSP (got '3.0'); allowed: 1.0, 2.0"),
        (document(system("") + system("")), "SystemStructure.ssd: must hold one <System> (got 2)"),
        ("<a>" * 40 + "</a>" * 40, "SystemStructure.ssd:1: elements are nested more than 32 deep"),
    ],
)
def test_a_description_that_is_none_is_refused(tmp_path: Path, text: str, message: str) -> None:
    assert problems(tmp_path, text)[0].startswith(message)


def test_an_archive_that_holds_itself_comes_to_an_end(tmp_path: Path) -> None:
    again = system(component("again", "a.ssd", attributes='type="application/x-ssp-definition"'))
    (tmp_path / "a.ssd").write_text(document(again))
    with pytest.raises(CosimError, match="system structures refer to one another more than 16 deep"):
        read_ssp(tmp_path / "a.ssd")
    itself = system(component("x", "#R"), attributes='id="R"')
    assert problems(tmp_path, document(itself)) == ["SystemStructure.ssd:1: x: a system refers to itself (got 'R')"]


def test_systems_that_multiply_by_reference_come_to_an_end(tmp_path: Path) -> None:
    many = "".join(component(f"x{i}", "b.ssd", attributes='type="application/x-ssp-definition"') for i in range(10))
    (tmp_path / "a.ssd").write_text(document(system(many)))
    (tmp_path / "b.ssd").write_text(document(system(many)))
    with pytest.raises(CosimError, match="is one too many in the system structure; allowed: at most 10000 elements"):
        read_ssp(tmp_path / "a.ssd")
    levels = "".join(
        system(
            "".join(component(f"x{i}", f"#L{n + 1}") for i in range(10)) if n < 9 else "",
            name=f"s{n}",
            attributes=f'id="L{n}"',
        )
        for n in range(10)
    )
    (tmp_path / "c.ssd").write_text(document(system(levels)))
    with pytest.raises(CosimError, match="is one too many in the system structure"):
        read_ssp(tmp_path / "c.ssd")


def test_bad_archives_are_refused_as_bad_fmus_are(tmp_path: Path) -> None:
    path = tmp_path / "x.ssp"
    path.write_text("no archive")
    with pytest.raises(CosimError, match=r"x.ssp: is not a ZIP archive, so it is not an SSP"):
        load(path)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("../evil.ssd", "x")
    with pytest.raises(CosimError, match=r"../evil.ssd: is a path that leads out of the archive"):
        load(path)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("readme.txt", "x")
    with pytest.raises(CosimError, match=r"x.ssp: holds no SystemStructure.ssd, so it is not an SSP"):
        load(path)
    with pytest.raises(CosimError, match=r"gone.ssd: is not there"):
        load(tmp_path / "gone.ssd")


def test_the_private_folder_of_an_archive_lives_as_long_as_its_slaves(folder: Path) -> None:
    found = read(folder, document(system(PAIR, LOOP)))
    slave = found.slaves["mass"]
    assert isinstance(slave, FmuSlave)
    private = slave.path
    del found
    assert private.is_file()
    del slave
    assert not private.exists()
