"""modelDescription.xml of FMI 3.0, and what lies beside it: terminals and the build description."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from seacrane.fmi.terminals import Terminal
from seacrane.fmi.writing import (
    EXPERIMENT,
    HEAD,
    KINDS,
    LOG_CATEGORIES,
    about,
    attributes,
    names,
    number,
    state_of,
    units,
)
from seacrane.model.codegen import Entry, Generated
from seacrane.model.dae import PowerBond
from seacrane.model.dependencies import TIME, dependencies

SIDE: Final = 100.0
"""Half the side of the square in which the icon lies, in the units of its coordinate system."""


def describe(model: Generated, identifier: str) -> str:
    """The text of modelDescription.xml for co-simulation and model exchange."""
    root = {"fmiVersion": "3.0", "modelName": model.dae.name, "instantiationToken": model.guid, **about(model)}
    able = {
        "modelIdentifier": identifier,
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
        "providesDirectionalDerivatives": "true",
        "providesAdjointDerivatives": "true",
    }
    simulation = {**able, "canHandleVariableCommunicationStepSize": "true", "maxOutputDerivativeOrder": "1"}
    entries = (model.time, *model.entries)
    references = {e.variable.name: e.reference for e in entries}
    lines = [
        HEAD,
        f"<fmiModelDescription{attributes(root)}>",
        f"  <ModelExchange{attributes(able)}/>",
        f"  <CoSimulation{attributes(simulation)}/>",
        *units(entries),
        *LOG_CATEGORIES,
        EXPERIMENT,
        "  <ModelVariables>",
        *(_variable(e, references) for e in entries),
        "  </ModelVariables>",
        *_structure(model, references),
        "</fmiModelDescription>",
    ]
    return "\n".join(lines) + "\n"


def _variable(entry: Entry, references: dict[str, int]) -> str:
    v = entry.variable
    causality, variability, initial = KINDS[entry.kind]
    values = {
        "name": v.name,
        "valueReference": str(entry.reference),
        "description": v.about or None,
        "causality": causality,
        "variability": variability,
        "initial": initial,
        **number(entry),
        "derivative": str(references[state_of(entry)]) if entry.kind == "DERIVATIVE" else None,
    }
    return f"    <Float64{attributes(values)}/>"


def _structure(model: Generated, references: dict[str, int]) -> list[str]:
    known = dependencies(model.dae)

    def unknown(tag: str, name: str) -> str:
        depends = sorted(model.time.reference if n == TIME else references[n] for n in known[name])
        return f'    <{tag} valueReference="{references[name]}" dependencies="{" ".join(map(str, depends))}"/>'

    return [
        "  <ModelStructure>",
        *(unknown("Output", name) for name in names(model.entries, "OUTPUT")),
        *(unknown("ContinuousStateDerivative", name) for name in names(model.entries, "DERIVATIVE")),
        *(
            f'    <InitialUnknown valueReference="{references[name]}"/>'
            for name in names(model.entries, "OUTPUT", "DERIVATIVE")
        ),
        *(f'    <EventIndicator valueReference="{references[n]}"/>' for n in names(model.entries, "INDICATOR")),
        "  </ModelStructure>",
    ]


def build_description(identifier: str, sources: Sequence[str]) -> str:
    """The text of sources/buildDescription.xml: the files to be compiled, in C11, into one library."""
    lines = [
        HEAD,
        '<fmiBuildDescription fmiVersion="3.0">',
        f'  <BuildConfiguration modelIdentifier="{identifier}">',
        '    <SourceFileSet language="C11">',
        *(f'      <SourceFile name="{name}"/>' for name in sources),
        '      <PreprocessorDefinition name="CASADI_SYMBOL_EXPORT" value=""/>',
        "    </SourceFileSet>",
        '    <Library name="m" description="the mathematical functions of C" external="true"/>',
        "  </BuildConfiguration>",
        "</fmiBuildDescription>",
    ]
    return "\n".join(lines) + "\n"


def terminals_and_icons(terminals: Sequence[Terminal]) -> str:
    """The text of terminalsAndIcons.xml: one terminal for each power bond, and where the icon lies.

    FMI 3.0 defines the file, and lets FMUs of earlier versions have it with its own version in it.
    """
    corners = f'x1="{-SIDE}" y1="{-SIDE}" x2="{SIDE}" y2="{SIDE}"'
    lines = [
        HEAD,
        '<fmiTerminalsAndIcons fmiVersion="3.0">',
        "  <GraphicalRepresentation>",
        f'    <CoordinateSystem {corners} suggestedScalingFactorTo_mm="0.1"/>',
        f"    <Icon {corners}/>",
        "  </GraphicalRepresentation>",
    ]
    if terminals:
        lines.append("  <Terminals>")
        for terminal in terminals:
            head = {
                "name": terminal.bond.name,
                "matchingRule": "plug",
                "terminalKind": f"_seacrane.power.{terminal.domain}",
                "description": f"{terminal.domain} power, positive {_way(terminal.bond)} the model",
            }
            lines.append(f"    <Terminal{attributes(head)}>")
            for member, variable, kind in (
                (terminal.across, terminal.bond.across, "signal"),
                (terminal.through, terminal.bond.through, "inflow" if terminal.bond.inward else "outflow"),
            ):
                values = {"variableName": variable, "memberName": member, "variableKind": kind}
                lines.append(f"      <TerminalMemberVariable{attributes(values)}/>")
            lines.append("    </Terminal>")
        lines.append("  </Terminals>")
    return "\n".join([*lines, "</fmiTerminalsAndIcons>"]) + "\n"


def _way(bond: PowerBond) -> str:
    return "into" if bond.inward else "out of"
