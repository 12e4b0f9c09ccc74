"""OSP's libcosim runs our drives as our master does: each by itself, and all of them coupled with the crane."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from crane_exports import Exported
from numpy.typing import NDArray

from seacrane import fmi
from seacrane.cosim import Execution, FmuSlave, Jacobi, System

pytest.importorskip("libcosimpy.CosimExecution", reason="libcosimpy (the extra `peers`) is not installed")

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

Values = dict[str, NDArray[np.float64]]

BONDS = {
    "slew": ("slew_drive.torque", "crane.slew.torque", "crane.slew_rate", "slew_drive.speed"),
    "boom": (
        "boom_drive.rod_force", "crane.boom_cylinder.force", "crane.boom_cylinder.velocity", "boom_drive.rod_velocity",
    ),
    "jib": ("jib_drive.rod_force", "crane.jib_cylinder.force", "crane.jib_cylinder.velocity", "jib_drive.rod_velocity"),
    "winch": ("winch_drive.torque", "crane.drum.torque", "crane.drum.speed", "winch_drive.speed"),
}  # fmt: skip
CONNECTIONS = [
    *((bond[0], bond[1]) for bond in BONDS.values()),
    *((bond[2], bond[3]) for bond in BONDS.values()),
    ("crane.boom_cylinder.extension", "boom_drive.rod_position"),
    ("crane.jib_cylinder.extension", "jib_drive.rod_position"),
]


def outputs(paths: Mapping[str, Path]) -> list[str]:
    return [
        f"{name}.{v.name}" for name, path in paths.items() for v in fmi.read(path).variables if v.causality == "output"
    ]


def ours(
    paths: Mapping[str, Path], connections: list[tuple[str, str]], given: Mapping[str, float], step: float, steps: int
) -> Values:
    system = System("drives")
    for name, path in paths.items():
        system.add(name, FmuSlave(path))
    for source, destination in connections:
        system.connect(source, destination)
    names = outputs(paths)
    with Execution(system, Jacobi(step=step)) as run:
        for name, value in given.items():
            run.set(name, value)
        run.start()
        rows = []
        for _ in range(steps):
            run.step(1)
            rows.append(run.values(names))
    return dict(zip(names, np.array(rows).T, strict=True))


def theirs(
    paths: Mapping[str, Path], connections: list[tuple[str, str]], given: Mapping[str, float], step: float, steps: int
) -> Values:
    execution = CosimExecution.from_step_size(round(step * 1e9))
    slaves = {name: CosimLocalSlave(str(path), name) for name, path in paths.items()}
    index = {name: execution.add_local_slave(slave) for name, slave in slaves.items()}
    references = {
        f"{name}.{v.name}": (index[name], v.value_reference)
        for name, path in paths.items()
        for v in fmi.read(path).variables
    }
    for source, destination in connections:
        execution.connect_real_variables(*references[source], *references[destination])
    for name, value in given.items():
        assert execution.real_initial_value(*references[name], value)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    names = outputs(paths)
    rows = []
    for _ in range(steps):
        assert execution.step()
        rows.append([observer.last_real_values(references[n][0], [references[n][1]])[0] for n in names])
    return dict(zip(names, np.array(rows).T, strict=True))


def assert_same(found: Values, expected: Values) -> None:
    for name, column in expected.items():
        assert found[name] == pytest.approx(column, rel=1e-9, abs=1e-9 * max(1e-9, np.abs(column).max())), name


@pytest.mark.parametrize("name", ["slew_drive", "boom_drive", "jib_drive", "winch_drive", "example"])
def test_a_drive_runs_as_in_our_master(exported: Exported, name: str) -> None:
    paths, given = {"drive": exported(name, "2.0")}, {"drive.spool": 0.3}
    expected = ours(paths, [], given, 0.01, 30)
    assert max(np.ptp(column) for column in expected.values()) > 0
    assert_same(theirs(paths, [], given, 0.01, 30), expected)


def test_all_drives_and_the_crane_run_as_in_our_master(exported: Exported) -> None:
    paths = {name: exported(name, "2.0") for name in ("slew_drive", "boom_drive", "jib_drive", "winch_drive", "crane")}
    given = {"boom_drive.spool": 0.3, "winch_drive.spool": 0.2, "slew_drive.spool": -0.2}
    expected = ours(paths, CONNECTIONS, given, 0.0005, 200)
    assert abs(expected["crane.slew_rate"][-1]) > 1e-6
    assert_same(theirs(paths, CONNECTIONS, given, 0.0005, 200), expected)
