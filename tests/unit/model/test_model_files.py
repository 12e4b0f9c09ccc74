"""Model files: exact round trips, every fault told at once with what was probably meant, nothing half-written."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from seacrane.errors import ModelFileError, StructureError
from seacrane.library import hydraulics as hyd
from seacrane.library import signals
from seacrane.model import REGISTRY, Component, Diagram, Hydraulic, files, load, parameter, save
from seacrane.model.files import FORMAT, check, interfaces, loads, migrated, public_name, to_json
from seacrane.units import Pressure, bar, l, mm

BOOM_DRIVE = Path(__file__).parents[3] / "examples" / "boom_drive.json"


def filling() -> Diagram:
    diagram = Diagram("filling", density=860.0)
    pump = diagram.add("pump", hyd.ConstantPressurePump(pressure=210 * bar))
    edge = diagram.add("edge", hyd.Orifice(diameter=3 * mm))
    volume = diagram.add("volume", hyd.ControlVolume(volume=5 * l, pressure=1e5 / 3))
    source = diagram.add("source", signals.RecordedInput(points=((0.0, 1.0), (2.5, 0.1)), unit="m3/s"))
    flow = diagram.add("flow", hyd.FlowInput())
    diagram.connect(pump.p, edge.a)
    diagram.connect(edge.b, volume.a, flow.p)
    diagram.connect(source.y, flow.set)
    return diagram


def content() -> dict[str, Any]:
    data: dict[str, Any] = json.loads(to_json(filling()))
    return data


def told(data: dict[str, Any]) -> list[str]:
    with pytest.raises(ModelFileError) as error:
        loads(json.dumps(data), origin="f.json")
    return [str(p) for p in error.value.problems]


def test_a_diagram_reads_back_equal() -> None:
    first = filling()
    second = loads(to_json(first))
    assert {n: p.component for n, p in second.parts.items()} == {n: p.component for n, p in first.parts.items()}
    assert second.shared == first.shared
    assert [[h.path for h in c] for c in second.connections] == [[h.path for h in c] for c in first.connections]
    assert to_json(second) == to_json(first)


def test_values_are_written_in_engineering_units_where_that_is_exact() -> None:
    data = content()
    assert data["parts"]["pump"]["parameters"]["pressure"] == "210 bar"
    assert data["parts"]["edge"]["parameters"]["diameter"] == "3 mm"
    assert data["shared"] == {"density": "860 kg/m3"}
    assert "density" not in data["parts"]["edge"]["parameters"]


def test_numbers_in_a_file_are_si() -> None:
    data = content()
    data["parts"]["pump"]["parameters"]["pressure"] = 21e6
    assert to_json(loads(json.dumps(data))) == to_json(filling())


def test_the_shipped_boom_drive_is_sound_and_keeps_its_values() -> None:
    assert check(BOOM_DRIVE) == []
    shipped, saved = json.loads(BOOM_DRIVE.read_text(encoding="utf-8")), json.loads(to_json(load(BOOM_DRIVE)))
    for name, part in shipped["parts"].items():
        assert part["parameters"].items() <= saved["parts"][name]["parameters"].items()
    assert saved["connections"] == shipped["connections"]
    assert saved["exposed"] == shipped["exposed"]


def test_every_component_of_the_library_has_a_public_name() -> None:
    found = interfaces()
    for component in REGISTRY:
        if component.__module__.startswith("seacrane.library"):
            assert issubclass(component, found[public_name(component)])
    assert found["hydraulics.DoubleActingCylinder"] is hyd.DoubleActingCylinder


def test_a_component_of_ones_own_is_named_by_its_module() -> None:
    class Leak(Component):
        pressure: Pressure = parameter("pressure", above=0)
        ports = {"a": Hydraulic()}

        def equations(self, m: Any) -> Any:
            yield m.a.p, self.pressure

    diagram = Diagram("test")
    diagram.add("leak", Leak(pressure=1e5))
    assert json.loads(to_json(diagram))["parts"]["leak"]["component"] == f"{__name__}.Leak"
    assert isinstance(loads(to_json(diagram)).parts["leak"].component, Leak)


def test_all_faults_of_a_file_are_told_at_once() -> None:
    data = content()
    data["nmae"] = "x"
    data["shared"] = {"density": "860 bar", "viscosit": 1.0}
    data["parts"]["pump"]["parameters"] = {"presure": "210 bar"}
    data["parts"]["edge"]["component"] = "hydraulics.Orifise"
    data["parts"]["volume"]["parameters"]["volume"] = "5 mm"
    data["parts"]["flow"]["level"] = "extended"
    data["connections"].append(["pump.q", "volum.a"])
    data["exposed"] = {"set": "source.x"}
    said = told(data)
    for expected in (
        "f.json: shared.viscosit: is no shared parameter of any component. Did you mean",
        "f.json: shared.density: a quantity in 'bar' cannot be given in 'kg/m3': ",
        "f.json: nmae: is not a field of a model. Did you mean 'name'?",
        "f.json: parts.pump.parameters.presure: is not a parameter. Did you mean 'pressure'?",
        "f.json: parts.pump.parameters.pressure: is missing: supply pressure (gauge) [Pa]",
        "f.json: parts.edge.component: is not a component (got 'hydraulics.Orifise'). Did you mean",
        "f.json: parts.volume.parameters.volume: a quantity in 'mm' cannot be given in 'm3': volume of oil",
        "f.json: parts.flow.level: hydraulics.FlowInput has no level 'extended'; allowed: none: it has one law",
        "f.json: connections[3]: pump has no port 'q'. ",
        "f.json: connections[3]: there is no part 'volum'. Did you mean 'volume'?",
        "f.json: exposed.set: source has no port 'x'. ",
    ):
        assert any(text.startswith(expected) for text in said), (expected, said)
    assert len(said) == 11


def test_a_unit_forgotten_is_questioned() -> None:
    data = content()
    data["parts"]["pump"]["parameters"]["pressure"] = 280
    (said,) = told(data)
    assert said.startswith("f.json: parts.pump.parameters.pressure: 280 Pa is implausible; did you mean 280 bar?")


def test_a_shared_value_is_checked_like_any_other() -> None:
    data = content()
    data["shared"] = {"density": "-860 kg/m3"}
    assert [s.split(";")[0] for s in told(data)] == ["f.json: shared.density: -860 kg/m3 is out of range"]


def test_a_shared_value_that_these_levels_do_not_use_is_no_fault() -> None:
    diagram = Diagram("tank", bulk_modulus=1.5e9)
    diagram.add("tank", hyd.Tank())
    assert loads(to_json(diagram)).shared == {"bulk_modulus": 1.5e9}


def test_a_class_of_a_level_is_led_to_interface_and_level() -> None:
    data = content()
    data["parts"]["pump"] = {"component": "hydraulics.ConstantPressurePump", "parameters": {"pressure": "1 bar"}}
    assert "Did you mean 'hydraulics.Pump' with level 'constant-pressure'?" in told(data)[0]


def test_ports_that_do_not_fit_are_told_with_their_connection() -> None:
    data = content()
    data["connections"][0] = ["pump.p", "source.y"]
    (said,) = told(data)
    assert said.startswith("f.json: connections[0]: a signal cannot be joined to a power port: pump.p (hydraulic)")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is not JSON"),
        ("[1]", "the file must be a JSON object"),
        ('{"name": "a", "name": "b"}', "gives a field twice"),
        ('{"name": "a"}', "format: is missing"),
        ('{"format": "seacrane-model/99"}', "is of a format that this version cannot read"),
        ('{"format": "seacrane-model/1"}', "name: must be a text"),
        ('{"format": "seacrane-model/1", "name": "a", "parts": []}', "parts: must be an object"),
        ('{"format": "seacrane-model/1", "name": "a", "parts": {"b": 3}}', "parts.b: must be an object"),
        ('{"format": "seacrane-model/1", "name": "a", "parts": {"b": {}}}', "parts.b.component: is missing"),
        ('{"format": "seacrane-model/1", "name": "a", "connections": {}}', "connections: must be a list"),
        ('{"format": "seacrane-model/1", "name": "a", "connections": [3]}', "connections[0]: must be a list of ports"),
        ('{"format": "seacrane-model/1", "name": "a", "connections": [[3]]}', "connections[0]: must name a port"),
    ],
)
def test_what_is_no_model_is_refused(text: str, message: str) -> None:
    with pytest.raises(ModelFileError) as error:
        loads(text, origin="f.json")
    assert message in str(error.value)


@pytest.mark.parametrize("value", [True, None, [1], {"a": 1}, float("inf"), float("nan"), 10**400])
def test_what_is_no_number_is_refused(value: Any) -> None:
    data = content()
    data["parts"]["pump"]["parameters"]["pressure"] = value
    assert told(data)[0].startswith("f.json: parts.pump.parameters.pressure: must be a")


def nested() -> Diagram:
    inner = filling()
    inner.expose(inlet=inner.parts["edge"].a)
    outer = Diagram("outer", bulk_modulus=1.4e9)
    drive = outer.add("drive", inner)
    tank = outer.add("tank", hyd.Tank())
    outer.connect(drive.inlet, tank.p)
    return outer


def test_a_diagram_in_a_diagram_reads_back_equal() -> None:
    text = to_json(nested())
    assert json.loads(text)["parts"]["drive"]["diagram"]["name"] == "filling"
    assert json.loads(text)["shared"] == {"bulk_modulus": "14000 bar"}
    assert to_json(loads(text)) == text


def test_faults_inside_a_diagram_in_a_diagram_are_told_with_their_place() -> None:
    data = json.loads(to_json(nested()))
    data["parts"]["drive"]["diagram"]["parts"]["pump"]["parameters"]["pressure"] = "210 baar"
    data["connections"].append(["drive.inlett", "tank.p"])
    said = told(data)
    assert said[0].startswith("f.json: parts.drive.diagram.parts.pump.parameters.pressure: unknown unit 'baar'")
    assert said[1].startswith("f.json: connections[1]: drive has no port 'inlett'. Did you mean 'inlet'?")
    assert len(said) == 2


def test_diagrams_nested_without_end_are_refused() -> None:
    data: dict[str, Any] = {"name": "a"}
    for _ in range(240):
        data = {"name": "a", "parts": {"b": {"diagram": data}}}
    assert "nested too deeply" in told({**data, "format": FORMAT})[0]


def test_the_example_of_the_module_is_sound() -> None:
    example = files.__doc__.split("\n\n")[1] if files.__doc__ else ""
    assert loads(example).bond_graph().findings == ()


def test_older_formats_are_brought_up_step_by_step() -> None:
    def first(data: dict[str, Any]) -> dict[str, Any]:
        return {**data, "format": "old/2", "steps": 1}

    def second(data: dict[str, Any]) -> dict[str, Any]:
        return {**data, "format": FORMAT, "steps": data["steps"] + 1}

    migrations = {"old/1": first, "old/2": second}
    assert migrated({"format": "old/1", "name": "a"}, migrations) == {"format": FORMAT, "name": "a", "steps": 2}
    with pytest.raises(ModelFileError):
        migrated({"format": "old/1"}, {"old/1": lambda data: data})


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(ModelFileError, match="cannot be read: No such file"):
        load(tmp_path / "none.json")


def test_saving_leaves_one_whole_file(tmp_path: Path) -> None:
    save(filling(), tmp_path / "model.json")
    save(filling(), tmp_path / "model.json")
    assert [p.name for p in tmp_path.iterdir()] == ["model.json"]
    assert to_json(load(tmp_path / "model.json")) == to_json(filling())


def test_check_tells_what_the_equations_lack(tmp_path: Path) -> None:
    diagram = Diagram("loose")
    diagram.add("pump", hyd.ConstantPressurePump(pressure=100 * bar))
    save(diagram, tmp_path / "loose.json")
    with pytest.raises(StructureError):
        load(tmp_path / "loose.json").compile()
    assert any("is connected to nothing" in str(p) for p in check(tmp_path / "loose.json"))
