"""A saved state continues bit for bit: at once, in another process, in every version and kind; any other is refused."""

import subprocess
import sys
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest

from seacrane import fmi
from seacrane.errors import FmuError
from seacrane.fmi.export import Version
from seacrane.model.dae import Dae

WATCHED = ["force", "flow", "piston.x", "chamber.p", "power"]

CONTINUES = """
import sys
from pathlib import Path
from seacrane import fmi
path, kind, saved, names = sys.argv[1:]
with fmi.Fmu(path, kind) as fmu, fmu.instantiate("again") as run:
    run.initialize(0.0)
    run.restore(Path(saved).read_bytes())
    for k in range(5, 10):
        run.set("spool", 0.1 * k)
        run.step(0.01 * k, 0.01)
    print(*(value.hex() for value in run.get(names.split(","))))
"""


@pytest.fixture(scope="module", params=list(product(["2.0", "3.0"], ["co-simulation", "model-exchange"])), ids=str)
def saved(
    request: pytest.FixtureRequest, cylinder: Dae, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, fmi.Kind, bytes, list[float]]:
    """An FMU, its kind, its state after five steps, and what it gives after five more."""
    version, kind = request.param
    path = fmi.export(cylinder, tmp_path_factory.mktemp("state") / "piston.fmu", version=version)
    with fmi.Fmu(path, kind) as fmu, fmu.instantiate() as run:
        run.initialize(0.0)
        drive(run, 0, 5)
        state = run.save()
        drive(run, 5, 10)
        return path, kind, state, list(run.get(WATCHED))


def drive(run: fmi.FmuInstance, first: int, last: int) -> None:
    for k in range(first, last):
        run.set("spool", 0.1 * k)
        run.step(0.01 * k, 0.01)


def test_a_rollback_repeats_bit_for_bit(saved: tuple[Path, fmi.Kind, bytes, list[float]]) -> None:
    path, kind, state, expected = saved
    with fmi.Fmu(path, kind) as fmu, fmu.instantiate() as run:
        run.initialize(0.0)
        drive(run, 0, 7)
        for _ in range(2):
            run.restore(state)
            drive(run, 5, 10)
            assert list(run.get(WATCHED)) == expected


def test_a_state_continues_in_a_new_process_bit_for_bit(
    saved: tuple[Path, fmi.Kind, bytes, list[float]], tmp_path: Path
) -> None:
    path, kind, state, expected = saved
    (tmp_path / "state").write_bytes(state)
    command = [sys.executable, "-c", CONTINUES, path, kind, tmp_path / "state", ",".join(WATCHED)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert [float.fromhex(text) for text in done.stdout.split()] == expected


def test_a_state_that_is_none_of_this_model_is_refused_and_the_run_goes_on(
    saved: tuple[Path, fmi.Kind, bytes, list[float]], cylinder: Dae, tmp_path: Path
) -> None:
    path, kind, state, expected = saved
    version: Version = "2.0" if fmi.read(path).fmi_version == "2.0" else "3.0"
    heavier = tuple(replace(v, start=501.0) if v.name == "mass" else v for v in cylinder.parameters)
    older = fmi.export(replace(cylinder, parameters=heavier), tmp_path / "older.fmu", version=version)
    with fmi.Fmu(older, kind) as fmu, fmu.instantiate() as run:
        run.initialize(0.0)
        of_another = run.save()
    other: fmi.Kind = "model-exchange" if kind == "co-simulation" else "co-simulation"
    with fmi.Fmu(path, other) as fmu, fmu.instantiate() as run:
        run.initialize(0.0)
        of_another_kind = run.save()
    with fmi.Fmu(path, kind) as fmu, fmu.instantiate() as run:
        run.initialize(0.0)
        drive(run, 0, 5)
        for wrong, reason in (
            (of_another, "belongs to another model, or to another version of this one"),
            (bytes(len(state)), "not the state of a model"),
            (state[:-8], "bytes are not a saved state of this model"),
            (b"", "saved state"),
            (of_another_kind, "state"),
        ):
            with pytest.raises(FmuError, match=reason):
                run.restore(wrong)
        drive(run, 5, 10)
        assert list(run.get(WATCHED)) == expected
