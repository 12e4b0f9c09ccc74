"""Our models and their FMUs, for other people's tools: the parts of the reference crane and the shipped example."""

from pathlib import Path

import pytest
from crane_exports import Exported

from seacrane import design, fmi, model, plant
from seacrane.fmi.export import Version
from seacrane.model import Dae

EXAMPLE = Path(__file__).parents[2] / "examples" / "boom_drive.json"


@pytest.fixture(scope="session")
def models() -> dict[str, Dae]:
    parts = plant.parts(design.load("offshore-100t"))
    diagrams = {**parts, "example": model.load(EXAMPLE)}
    return {name: part if isinstance(part, Dae) else part.compile() for name, part in diagrams.items()}


@pytest.fixture(scope="session")
def exported(models: dict[str, Dae], tmp_path_factory: pytest.TempPathFactory) -> Exported:
    """The FMU of a model in a version of FMI, with sources; each is written once."""
    folder, written = tmp_path_factory.mktemp("fmus"), {}

    def fmu(name: str, version: Version) -> Path:
        path = folder / f"{name}-{version}.fmu"
        if path not in written:
            written[path] = fmi.export(models[name], path, version=version, sources=True)
        return path

    return fmu
