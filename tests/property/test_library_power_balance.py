"""Every component of the library, found by itself: no power appears or vanishes, and no slope is undefined.

Each component stands alone with all its ports given from outside: the across variable where the law allows it, else the
through variable. Parameters, states and inputs are drawn at random, exact zeros among them.
"""

import itertools
import math
from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest

import seacrane.library.hydraulics as hyd
import seacrane.library.mechanics as mec
import seacrane.library.signals as sig
from seacrane.errors import ParameterError, StructureError
from seacrane.model import REGISTRY, Component, Dae, Diagram
from seacrane.model.ports import Hydraulic, PowerPort, Rotational, Translational

LIBRARY = [cls for cls in REGISTRY if cls.__module__.startswith(hyd.__name__.rpartition(".")[0])]
POINTS = 200
OPTIONS = {"points": ((0.0, 1.0), (1.0, -2.0), (4.0, 3.0))}
"""A value for every option that has no default."""
THROUGH_GIVEN = {Hydraulic: hyd.FlowInput, Translational: mec.ForceInput, Rotational: mec.TorqueInput}
SIGNAL = {"FlowInput": "set", "ForceInput": "F", "TorqueInput": "T"}


@dataclass(frozen=True)
class Bench:
    """One component alone in a diagram, and the numbers of its model by name."""

    dae: Dae
    evaluate: ca.Function
    ports: tuple[tuple[str, PowerPort], ...]

    def values(self, t, p, x, u):
        names = [v.name for v in (*self.dae.outputs, *self.dae.observables, *self.dae.inputs)]
        out, obs, _, _, _ = (np.asarray(e).ravel() for e in self.evaluate(t, p, x, u))
        return dict(zip(names, [*out, *obs, *u], strict=True))


def draw_parameter(rng, declaration, quantity):
    low = max(b for b in (declaration.above, declaration.least, -math.inf) if b is not None)
    high = min(b for b in (declaration.below, declaration.most, math.inf) if b is not None)
    typical = quantity.plausible if quantity and quantity.plausible else (1e-3, 1e3)
    low_size = max(low, typical[0]) if low >= 0 else typical[0]
    size = math.exp(rng.uniform(math.log(low_size), math.log(max(min(high, typical[1]), low_size))))
    choices = [size] * 4 + [v for v in (0.0, -size) if declaration.admits(v)]
    return float(rng.choice(choices))


def draw_component(rng, cls) -> Component:
    for _ in range(1000):
        given = {}
        for name, (declaration, quantity) in cls.declarations.items():
            if declaration.role in ("parameter", "shared"):
                given[name] = draw_parameter(rng, declaration, quantity)
            elif declaration.role == "option" and name in OPTIONS:
                given[name] = OPTIONS[name]
        try:
            return cls(**given)
        except ParameterError:
            continue
    raise AssertionError(f"no admissible parameters drawn for {cls.__name__}")


def bench(component: Component) -> Bench:
    ports = component.interface()
    power = [(name, port) for name, port in ports.items() if isinstance(port, PowerPort)]
    failures = []
    for across_given in itertools.product((True, False), repeat=len(power)):
        diagram = Diagram("bench")
        part = diagram.add("part", component)
        for (name, port), given in zip(power, across_given, strict=True):
            if given:
                diagram.expose(**{name: getattr(part, name)})
                continue
            source_class = THROUGH_GIVEN[type(port)]
            source = diagram.add(f"source_{name}", source_class())
            (end,) = [h for h in source if isinstance(h.port, PowerPort)]
            diagram.connect(getattr(part, name), end)
            diagram.expose(**{f"given_{name}": getattr(source, SIGNAL[source_class.__name__])})
        diagram.expose(**{f"signal_{n}": getattr(part, n) for n, p in ports.items() if not isinstance(p, PowerPort)})
        try:
            dae = diagram.compile()
        except StructureError as error:
            failures.append(str(error))
            continue
        if dae.algebraics:
            failures.append(f"the law of {type(component).__name__} is not explicit")
            continue
        results = ca.vertcat(dae.ode, dae.out, dae.obs)
        slopes = ca.jacobian(results, ca.vertcat(dae.x, dae.u))
        outputs = [dae.out, dae.obs, dae.ode, results, ca.densify(slopes)]
        return Bench(dae, ca.Function("bench", [dae.t, dae.p, dae.x, dae.u], outputs), tuple(power))
    raise AssertionError("\n".join(failures))


def draw_point(rng, dae: Dae, component: Component):
    """Parameters of `component`, and random states and inputs, one in five of them exactly zero."""

    def parameter(name):
        return float(getattr(component, name.removeprefix("part.")))

    p = [parameter(v.name) if _owned(v.name) else v.start for v in dae.parameters] + [v.start for v in dae.modes]
    nominal = {"Pa": 1e7, "m3/s": 1e-2, "N": 1e5, "N.m": 1e4, "rad/s": 10.0}

    def numbers(variables):
        size = np.array([nominal.get(v.unit, v.nominal) for v in variables])
        random = rng.normal(size=len(variables)) * 10.0 ** rng.uniform(-3, 0.5, len(variables))
        return size * random * (rng.random(len(variables)) > 0.2)

    return rng.uniform(0, 5), np.array(p), numbers(dae.states), numbers(dae.inputs)


def _owned(name):
    return name.startswith("part.") or "." not in name


def power_into(ports, values):
    return [values[f"part.{n}.{p.across}"] * values[f"part.{n}.{p.through}"] for n, p in ports]


def test_the_walk_finds_the_library():
    assert len(LIBRARY) > 35
    assert {cls.__module__.split(".")[2] for cls in LIBRARY} == {"hydraulics", "mechanics", "signals"}
    assert hyd.Orifice in LIBRARY
    assert sig.PID in LIBRARY


@pytest.mark.parametrize("cls", LIBRARY, ids=lambda cls: cls.__name__)
def test_power_in_is_stored_lost_or_passed_on(cls):
    rng = np.random.default_rng(sum(map(ord, cls.__name__)))
    alone = bench(draw_component(rng, cls))
    has_power = any(isinstance(p, PowerPort) for p in cls.ports.values())
    for _ in range(POINTS):
        point = draw_point(rng, alone.dae, draw_component(rng, cls))
        values = alone.values(*point)
        accounts = [values.get(f"part.{name}_power", 0.0) for name in ("stored", "lost", "supplied")]
        if not has_power:
            assert accounts == [0.0, 0.0, 0.0]
            continue
        stored, lost, supplied = accounts
        powers = power_into(alone.ports, values)
        within = [values[v.name] for v in alone.dae.observables if v.unit == "W"]  # parts that pass power to each other
        scale = sum(map(abs, [*powers, *accounts, *within]))
        assert sum(powers) - (stored + lost - supplied) == pytest.approx(0.0, abs=1e-9 * scale + 1e-300)
        assert lost >= -1e-9 * scale


@pytest.mark.parametrize("cls", LIBRARY, ids=lambda cls: cls.__name__)
def test_every_value_and_slope_is_finite_even_at_rest(cls):
    rng = np.random.default_rng(sum(map(ord, cls.__name__)))
    component = draw_component(rng, cls)
    alone = bench(component)
    _, p, x, u = draw_point(rng, alone.dae, component)
    at_rest = [(0.0, p, 0 * x, 0 * u)]
    for point in at_rest + [draw_point(rng, alone.dae, draw_component(rng, cls)) for _ in range(POINTS)]:
        *_, results, slopes = alone.evaluate(*point)
        assert np.isfinite(np.asarray(results)).all()
        assert np.isfinite(np.asarray(slopes)).all()
