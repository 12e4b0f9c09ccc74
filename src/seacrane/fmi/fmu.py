"""Other people's FMUs (and ours): unpacked into a private folder, loaded, and run.

with Fmu("pump.fmu") as pump, pump.instantiate("pump1") as run:
    run.set("speed", 150.0)
    run.initialize(0.0)
    run.step(0.0, 0.01)
    run.get("flow")
"""

from __future__ import annotations

import re
import shutil
import tempfile
import weakref
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Final, Literal, Self

from seacrane.errors import FmuError
from seacrane.fmi.api import BY_VERSION, load
from seacrane.fmi.archive import opened, unpack
from seacrane.fmi.description import Capabilities, ModelDescription
from seacrane.fmi.instance import FmuInstance
from seacrane.fmi.platforms import binary_path, host, platforms
from seacrane.fmi.reading import read_archive
from seacrane.fmi.xml import LARGEST

_ICON: Final = re.compile(r"model\.png|terminalsAndIcons/[^/]+\.(png|svg)")

Kind = Literal["co-simulation", "model-exchange"]


def read(path: str | Path) -> ModelDescription:
    """The model description of an FMU, without unpacking or loading it. Raises `FmuError` with all problems."""
    with opened(Path(path)) as archive:
        return read_archive(archive)


def icons(path: str | Path) -> dict[str, bytes]:
    """The pictures of an FMU by their names in it: of the FMU, and of its terminals in `terminalsAndIcons`."""
    with opened(Path(path)) as archive:
        return {
            entry.filename: archive.read(entry)
            for entry in archive.infolist()
            if _ICON.fullmatch(entry.filename) and entry.file_size <= LARGEST
        }


class Fmu:
    """An FMU of FMI 1.0 (co-simulation), 2.0 or 3.0, unpacked and its library loaded.

    Close it, or use it in a `with` block.

    An FMU of both kinds is run for co-simulation unless `kind` says otherwise. One for model exchange is integrated
    here, by RODAS with located events.

    Raises `FmuError` if the archive, the model description or the library for this platform is not as it must be. The
    private folder is removed in any case.
    """

    def __init__(self, path: str | Path, kind: Kind | None = None) -> None:
        self.path = Path(path)
        with opened(self.path) as archive:
            self.description = read_archive(archive)
            self.exchange, self.capabilities = self._choose(kind)
            self._refuse_clocks()
            self.api = BY_VERSION[self.description.fmi_version]
            binary = self._binary(archive.namelist())
            self.folder = Path(tempfile.mkdtemp(prefix="seacrane-fmu-"))
            self._remove = weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
            try:
                unpack(archive, self.folder)
                identifier = self.capabilities.model_identifier
                self.library = load(self.folder / binary, self.path.name, self.api, identifier, self.exchange)
            except BaseException:
                self._remove()
                raise
        self.open_instances = 0
        self._unloaded = False

    def _choose(self, kind: Kind | None) -> tuple[bool, Capabilities]:
        """Whether for model exchange, and what the FMU can do then."""
        d = self.description
        slave, model = d.co_simulation, d.model_exchange
        if d.fmi_version == "1.0":
            self._refuse_version_1(d)
        if kind != "model-exchange" and slave is not None:
            return False, slave
        if kind != "co-simulation" and model is not None:
            return True, model
        if slave is None and model is None:
            raise FmuError.at(
                self.path.name,
                "is for scheduled execution only, which is not supported" if d.scheduled_execution else "is of no kind",
                allowed="an FMU with a <CoSimulation> or <ModelExchange> element",
            )
        there = "co-simulation" if slave is not None else "model-exchange"
        raise FmuError.at(self.path.name, f"is not made for {kind}", allowed=there)

    def _refuse_version_1(self, d: ModelDescription) -> None:
        if d.co_simulation is None:
            reason = "is for model exchange of FMI 1.0, which is not supported"
        elif d.co_simulation.needs_execution_tool:
            reason = "couples a tool that has to be installed (CoSimulation_Tool of FMI 1.0), which is not supported"
        else:
            return
        hint = "Ask for an export as FMI 2.0 or 3.0."
        raise FmuError.at(self.path.name, reason, allowed="CoSimulation_StandAlone in FMI 1.0", hint=hint)

    def _refuse_clocks(self) -> None:
        ticked = [v.name for v in self.description.inputs if v.type == "Clock"]
        if ticked:
            message = (
                f"whoever runs it must tick its input clocks ({', '.join(ticked[:5])}), and clocks are not supported"
            )
            raise FmuError.at(self.path.name, message)

    def _binary(self, names: Sequence[str]) -> str:
        version = self.description.fmi_version
        binary = binary_path(self.capabilities.model_identifier, version)
        if binary not in names:
            raise FmuError.at(
                self.path.name,
                f"has no binary for this platform: {binary}",
                value=", ".join(platforms(names)) or "none",
                allowed=host(version)[0],
            )
        return binary

    def instantiate(self, name: str = "", *, logging: bool = False, tolerance: float | None = None) -> FmuInstance:
        """A new instance; `logging` asks the FMU for its debug log. Raises `FmuError` if it refuses.

        `tolerance` is the relative tolerance of the solver of an FMU for model exchange; by default it is that of the
        FMU's experiment, or 1e-6.
        """
        if self._unloaded:
            raise FmuError.at(self.path.name, "has been closed")
        return FmuInstance(self, name or self.description.model_name, logging, tolerance)

    def close(self) -> None:
        """Removes the private folder and unloads the library, which stays while an instance of it is not closed."""
        self._remove()
        if not self.open_instances and not self._unloaded:
            self._unloaded = True
            self.library.unload()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
