"""Other masters in the shape that `cosim.py` measures: made from a case, `step(steps)`, and the `last` value logged."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass
class Case:
    """FMUs by name, their connections (from, output, to, input), the macro step [s], what is logged, start values."""

    name: str
    slaves: dict[str, Path]
    joined: list[tuple[str, str, str, str]]
    step: float
    logged: list[tuple[str, str]]
    starts: dict[str, dict[str, float]] = field(default_factory=dict)


MISSING: dict[str, str] = {}
"""Peers that are not installed, and why."""

PEERS: dict[str, Callable[[Case, bool], Any]] = {}


# ---------------------------------------------------------------- FMPy
class FMPy:
    """The loop that one writes with FMPy's slaves: set all inputs, step all, get all outputs."""

    def __init__(self, case: Case, logging: bool) -> None:
        self.case, self.time, self.rows = case, 0.0, [] if logging else None
        self.slaves, self.outputs, self.inputs = {}, {}, []
        for name, path in case.slaves.items():
            read = fmpy.read_model_description(str(path), validate=False)
            references = {v.name: v.valueReference for v in read.modelVariables}
            slave = FMU2Slave(
                guid=read.guid,
                unzipDirectory=fmpy.extract(str(path)),
                modelIdentifier=read.coSimulation.modelIdentifier,
                instanceName=name,
            )
            slave.instantiate()
            slave.setupExperiment(startTime=0.0)
            slave.enterInitializationMode()
            for variable, value in case.starts.get(name, {}).items():
                slave.setReal([references[variable]], [value])
            slave.exitInitializationMode()
            taken = [(entry, source, output) for source, output, target, entry in case.joined if target == name]
            self.slaves[name] = slave
            self.outputs[name] = [v.name for v in read.modelVariables if v.causality == "output"]
            self.inputs.append((slave, [references[u] for u, _, _ in taken], [(s, y) for _, s, y in taken]))
            slave.read = [references[y] for y in self.outputs[name]]
        self._get()

    def _get(self) -> None:
        self.values = {
            (name, output): value
            for name, slave in self.slaves.items()
            for output, value in zip(self.outputs[name], slave.getReal(slave.read), strict=True)
        }

    def step(self, steps: int) -> None:
        for _ in range(steps):
            for slave, references, sources in self.inputs:
                if references:
                    slave.setReal(references, [self.values[source] for source in sources])
            for slave in self.slaves.values():
                slave.doStep(currentCommunicationPoint=self.time, communicationStepSize=self.case.step)
            self._get()
            self.time += self.case.step
            if self.rows is not None:
                self.rows.append([self.values[end] for end in self.case.logged])

    def last(self) -> float:
        return float(self.values[self.case.logged[-1]])


try:
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    PEERS["FMPy"] = FMPy
except ImportError as error:
    MISSING["FMPy"] = str(error)


# ---------------------------------------------------------------- libcosim
SSP1 = "http://ssp-standard.org/SSP1/"


def ssd(case: Case, files: dict[str, str], workers: int | None) -> str:
    """The case as a system structure description for OSP."""
    taken = {name: [(t, u) for _, _, t, u in case.joined if t == name] for name in case.slaves}
    given = {name: {y for s, y, _, _ in case.joined if s == name} for name in case.slaves}
    parts = "".join(
        f'<ssd:Component name="{name}" source="{files[name]}"><ssd:Connectors>'
        + "".join(f'<ssd:Connector name="{u}" kind="input"><ssc:Real/></ssd:Connector>' for _, u in taken[name])
        + "".join(f'<ssd:Connector name="{y}" kind="output"><ssc:Real/></ssd:Connector>' for y in sorted(given[name]))
        + "</ssd:Connectors></ssd:Component>"
        for name in case.slaves
    )
    joined = "".join(
        f'<ssd:Connection startElement="{s}" startConnector="{y}" endElement="{t}" endConnector="{u}"/>'
        for s, y, t, u in case.joined
    )
    threads = "" if workers is None else f' numWorkerThreads="{workers}"'
    return (
        f'<?xml version="1.0"?><ssd:SystemStructureDescription name="c" version="1.0" '
        f'xmlns:ssd="{SSP1}SystemStructureDescription" xmlns:ssc="{SSP1}SystemStructureCommon" '
        'xmlns:osp="http://opensimulationplatform.com/SSP/OSPAnnotations">'
        f'<ssd:System name="r"><ssd:Elements>{parts}</ssd:Elements>'
        f"<ssd:Connections>{joined}</ssd:Connections></ssd:System>"
        '<ssd:DefaultExperiment startTime="0"><ssd:Annotations><ssc:Annotation type="com.opensimulationplatform">'
        f'<osp:Algorithm><osp:FixedStepAlgorithm baseStepSize="{case.step}"{threads}/></osp:Algorithm></ssc:Annotation>'
        "</ssd:Annotations></ssd:DefaultExperiment></ssd:SystemStructureDescription>"
    )


class Libcosim:
    """libcosim by its Python package, from a system structure description."""

    def __init__(self, case: Case, logging: bool, workers: int | None = None) -> None:
        log_output_level(CosimLogLevel.ERROR)
        self.case = case
        with tempfile.TemporaryDirectory(prefix="seacrane-benchmark-") as folder:
            files = {name: path.name for name, path in case.slaves.items()}
            for path in {*case.slaves.values()}:
                shutil.copy(path, folder)
            (Path(folder) / "SystemStructure.ssd").write_text(ssd(case, files, workers))
            self.execution = CosimExecution.from_ssp_file(folder)
        self.index = {name: self.execution.slave_index_from_instance_name(name) for name in case.slaves}
        self.references = {name: self._references(i) for name, i in self.index.items()}
        for name, values in case.starts.items():
            for variable, value in values.items():
                self.execution.real_initial_value(self.index[name], self.references[name][variable], value)
        self.observer = CosimObserver.create_time_series(buffer_size=100_000) if logging else None
        self.latest = None
        if self.observer is not None:
            self.execution.add_observer(self.observer)
            for name, output in case.logged:
                at = self.index[name], self.references[name][output]
                self.observer.start_time_series(*at, CosimVariableType.REAL)
        self.execution.step()  # initialises
        self.steps = 1

    def _references(self, index: int) -> dict[str, int]:
        found = self.execution.slave_variables(index)
        return {v.name.decode(): v.reference for v in found}

    def step(self, steps: int) -> None:
        assert self.execution.step(steps)
        self.steps += steps

    def last(self) -> float | None:
        if self.observer is None:
            return None
        name, output = self.case.logged[-1]
        at = self.index[name], self.references[name][output]
        return float(self.observer.time_series_real_samples(*at, self.steps, 1)[2][0])


try:
    from libcosimpy.CosimEnums import CosimVariableType
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    PEERS["libcosimpy, default"] = Libcosim
    PEERS["libcosimpy, 0 worker threads"] = lambda case, logging: Libcosim(case, logging, 0)
except (ImportError, OSError) as error:
    MISSING["libcosimpy"] = str(error)


# ---------------------------------------------------------------- ecos
class Ecos:
    """ecos by its Python package; what it logs goes to a CSV file."""

    def __init__(self, case: Case, logging: bool) -> None:
        EcosLib.set_log_level("err")
        self.case, self.folder = case, tempfile.TemporaryDirectory(prefix="seacrane-benchmark-")
        structure = EcosSimulationStructure()
        for name, path in case.slaves.items():
            structure.add_model(name, str(path.resolve()))
        for source, output, target, entry in case.joined:
            structure.make_real_connection(f"{source}::{output}", f"{target}::{entry}")
        starts = {f"{n}::{v}": value for n, values in case.starts.items() for v, value in values.items()}
        if starts:
            structure.add_parameter_set("starts", starts)
        self.simulation = EcosSimulation(structure=structure, step_size=case.step)
        if logging:
            logged = [f"{name}::{output}" for name, output in case.logged]
            self.simulation.add_csv_writer(str(Path(self.folder.name) / "log.csv"), identifiers=logged)
        self.simulation.init(parameter_set="starts" if starts else None)

    def step(self, steps: int) -> None:
        self.simulation.step(steps)

    def last(self) -> float:
        return float(self.simulation.get_real("::".join(self.case.logged[-1])))


try:
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

    PEERS["ecospy"] = Ecos
except (ImportError, OSError) as error:
    MISSING["ecospy"] = str(error)
