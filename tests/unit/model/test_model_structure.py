"""The notation of bond graphs: what is read, and what is refused."""

from __future__ import annotations

import pytest

from seacrane.errors import StructureError
from seacrane.model import BondGraph
from seacrane.model.structure import Bond


def test_a_bar_marks_the_end_that_is_given_the_effort() -> None:
    graph = BondGraph("flow: 1, edge: R, oil: C", "a -> flow, flow ->| edge, flow |-> oil")
    assert graph.bonds == (Bond("a", "flow"), Bond("flow", "edge", "edge"), Bond("flow", "oil", "flow"))


def test_all_faults_of_a_bond_graph_are_told_at_once() -> None:
    with pytest.raises(StructureError) as error:
        BondGraph("flow: 1, flow: R, edge: X", "a > flow, a |->| edge")
    said = str(error.value)
    assert "'edge: X' is of no kind of element" in said
    assert "'flow' is the name of two elements" in said
    assert "'a > flow' is not a bond" in said
    assert "'a |->| edge' is not a bond" in said


def test_a_transformer_has_two_bonds() -> None:
    with pytest.raises(StructureError, match="gear, a TF, has 1 bonds"):
        BondGraph("gear: TF", "a -> gear")


def test_a_bond_graph_that_misses_a_port_is_named_with_the_nearest_name() -> None:
    problems = BondGraph("oil: C", "aa |-> oil").misfits("Volume", {"a"})
    assert [str(p) for p in problems] == [
        "Volume.bond_graph: port 'a' has 0 bonds, needs one",
        "Volume.bond_graph: 'aa' is no element and no power port. Did you mean 'a'?",
    ]


def test_a_modulated_element_and_a_signal_port_want_a_signal() -> None:
    graph = BondGraph("through: 1, edge: MR", "a -> through, through -> b, through ->| edge")
    told = [str(p) for p in graph.misfits("Orifice", {"a", "b"}, {"k"})]
    assert told == [
        "Orifice.bond_graph: 'edge' has no signal. Say 'edge' ~> or ~> 'edge'.",
        "Orifice.bond_graph: 'k' has no signal. Say 'k' ~> or ~> 'k'.",
    ]
    mended = BondGraph("through: 1, edge: MR", "a -> through, through -> b, through ->| edge, k ~> edge")
    assert mended.signals == (("k", "edge"),)
    assert mended.misfits("Orifice", {"a", "b"}, {"k"}) == []
    assert mended.misfits("Orifice", {"a", "b"}, {"x"})
