"""FMPy validates and runs every export: both versions of FMI, both kinds, with our results."""

import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import fmpy
import numpy as np
import pytest
from crane_exports import MODELS, Exported, excitation
from fmpy.validation import validate_fmu
from lxml import etree
from numpy.typing import NDArray

from seacrane import fmi
from seacrane.fmi.export import Version
from seacrane.model import Dae, NativeInstance, build

Reals = NDArray[np.float64]

END, STEP = 0.3, 0.01
TOLERANCE = 1e-11


@pytest.mark.parametrize("version", ["2.0", "3.0"])
@pytest.mark.parametrize("name", MODELS)
def test_another_validator_and_ours_find_nothing(exported: Exported, name: str, version: Version) -> None:
    path = exported(name, version)
    assert validate_fmu(str(path)) == []
    assert fmi.check(path) == []


@pytest.mark.parametrize("name", MODELS)
def test_what_lies_beside_the_description_keeps_the_schemas_of_the_standard(exported: Exported, name: str) -> None:
    schemas = Path(fmpy.__file__).parent / "schema" / "fmi3"
    beside = {"TerminalsAndIcons": "terminalsAndIcons/terminalsAndIcons.xml"}
    for version, files in (("2.0", beside), ("3.0", beside | {"BuildDescription": "sources/buildDescription.xml"})):
        with zipfile.ZipFile(exported(name, version)) as archive:
            for schema, file in files.items():
                etree.XMLSchema(etree.parse(schemas / f"fmi3{schema}.xsd")).assertValid(
                    etree.fromstring(archive.read(file))
                )


def table(time: Reals, values: dict[str, Reals]) -> Reals:
    """Inputs as FMPy takes them."""
    rows = np.zeros(time.size, dtype=[("time", float), *((name, float) for name in values)])
    rows["time"] = time
    for name, column in values.items():
        rows[name] = column
    return rows


@contextmanager
def started(dae: Dae, values: dict[str, Reals]) -> Iterator[NativeInstance]:
    """The model itself at time zero."""
    with build(dae).instantiate() as run:
        run.set(["solver.tolerance", *values], [TOLERANCE, *(column[0] for column in values.values())])
        run.initialize(0.0)
        yield run


def theirs(path: Path, kind: str, dae: Dae, inputs: Reals) -> Reals:
    return fmpy.simulate_fmu(
        str(path),
        fmi_type=kind,
        stop_time=END,
        output_interval=STEP,
        output=[v.name for v in dae.outputs],
        input=inputs,
        start_values={"solver.tolerance": TOLERANCE},
        relative_tolerance=TOLERANCE,
    )


def assert_same(dae: Dae, expected: Reals, found: Reals) -> None:
    """Within 1e-6 of the largest value of any output in the same unit: some are zero but for rounding."""
    largest: dict[str, float] = {}
    for v, column in zip(dae.outputs, expected.T, strict=True):
        largest[v.unit] = max(largest.get(v.unit, 0.0), float(np.abs(column).max()))
    far = {
        v.name: float(np.abs(found[v.name] - column).max()) / largest[v.unit]
        for v, column in zip(dae.outputs, expected.T, strict=True)
    }
    assert {name: part for name, part in far.items() if not part < 1e-6} == {}


@pytest.mark.parametrize("version", ["2.0", "3.0"])
@pytest.mark.parametrize("name", MODELS)
def test_co_simulation_with_ramps_gives_our_results(
    models: dict[str, Dae], exported: Exported, name: str, version: Version
) -> None:
    dae, grid = models[name], np.linspace(0.0, END, round(END / STEP) + 1)
    values = excitation(dae, np.clip((grid - 0.05) / 0.2, 0.0, 1.0))
    names = [v.name for v in dae.outputs]
    with started(dae, values) as run:
        rows = [run.get(names)]
        for k in range(grid.size - 1):
            run.set(list(values), [column[k] for column in values.values()])
            run.step(grid[k], STEP)
            rows.append(run.get(names))
    found = theirs(exported(name, version), "CoSimulation", dae, table(grid, values))
    assert found["time"] == pytest.approx(grid, abs=1e-9)
    assert_same(dae, np.array(rows), found)


@pytest.mark.parametrize("version", ["2.0", "3.0"])
@pytest.mark.parametrize("name", MODELS)
def test_model_exchange_with_ramps_gives_our_results(
    models: dict[str, Dae], exported: Exported, name: str, version: Version
) -> None:
    """A ramp is given as a stair of doubled times: FMPy does not apply inputs again while its solver runs."""
    dae, grid = models[name], np.linspace(0.0, END, round(END / STEP) + 1)
    jumps = np.arange(0.055, 0.25, STEP)
    time = np.concatenate([[0.0], np.repeat(jumps, 2), [END]])
    values = excitation(dae, np.repeat(np.linspace(0.0, 1.0, jumps.size + 1), 2))
    with started(dae, values) as run:
        expected = run.simulate(grid, [v.name for v in dae.outputs], {n: (time, c) for n, c in values.items()})
    found = theirs(exported(name, version), "ModelExchange", dae, table(time, values))
    rows = np.searchsorted(found["time"], grid - 1e-9)
    assert found["time"][rows] == pytest.approx(grid, abs=1e-9)
    assert_same(dae, expected, found[rows])
