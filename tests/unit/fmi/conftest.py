"""A small model with everything a model can have, and its FMU."""

import os
from pathlib import Path

import casadi as ca
import pytest
from balls import build

from seacrane import fmi
from seacrane.model.dae import Dae, Variable, column


@pytest.fixture(scope="session")
def cylinder() -> Dae:
    """A piston between two springs of fluid, with a valve pressure drop as algebraic unknown."""
    t, x, z, u, p = ca.SX.sym("t"), ca.SX.sym("x", 3), ca.SX.sym("z"), ca.SX.sym("u", 2), ca.SX.sym("p", 3)
    return Dae(
        "piston drive",
        (
            Variable("piston.x", "m", 0.1, 0.1),
            Variable("piston.v", "m/s"),
            Variable("chamber.p", "Pa", 5e6, 1e6, about="pressure <behind> the piston & before the valve"),
        ),
        (Variable("valve.q", "m3/s", 0.0, 1e-3),),
        (Variable("spool", "1", 0.2), Variable("load", "N", 1e4)),
        (
            Variable("area", "m2", 0.01, minimum=1e-6),
            Variable("mass", "kg", 500.0, minimum=0.1),
            Variable("supply", "Pa", 2e7, 1e6),
        ),
        (Variable("force", "N", nominal=1e4), Variable("flow", "m3/s", nominal=1e-3)),
        (Variable("power", "W", about="hydraulic power through the valve"),),
        t, x, z, u, p,
        column(x[1], (p[0] * x[2] - u[1] - 2e4 * x[1]) / p[1], 1e11 * (z - p[0] * x[1] - 1e-11 * x[2])),
        column(z * (1 + 1e4 * z**2) - u[0] * 1e-10 * (p[2] - x[2])),
        column(p[0] * x[2] + ca.sin(t), z),
        column(z * (p[2] - x[2])),
        about="a piston & its valve",
    )  # fmt: skip


@pytest.fixture(scope="session")
def piston_fmu(cylinder: Dae, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fmi.export(cylinder, tmp_path_factory.mktemp("fmu") / "piston.fmu")


@pytest.fixture(scope="session")
def balls(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    return build(tmp_path_factory.mktemp("balls"))


@pytest.fixture
def compiled_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing that was compiled before is found, but the C libraries that the compiler has prepared for itself."""
    kept = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "zig"
    monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", os.environ.get("ZIG_GLOBAL_CACHE_DIR", str(kept)))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
