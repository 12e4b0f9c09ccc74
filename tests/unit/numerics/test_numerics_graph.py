import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from seacrane.numerics.graph import components_in_order, match, reachable

graphs = st.integers(1, 12).flatmap(
    lambda n: st.lists(st.lists(st.integers(0, n - 1), max_size=4), min_size=n, max_size=n)
)


@given(graphs)
def test_components_are_those_of_scipy_and_come_after_what_they_need(successors):
    n = len(successors)
    found = components_in_order(successors)
    rows = [i for i, s in enumerate(successors) for _ in s]
    columns = [j for s in successors for j in s]
    matrix = csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(n, n))
    count, labels = connected_components(matrix, directed=True, connection="strong")
    assert len(found) == count
    assert all(len({labels[i] for i in component}) == 1 for component in found)
    position = {node: k for k, component in enumerate(found) for node in component}
    assert all(position[j] <= position[i] for i in range(n) for j in successors[i])


def test_a_long_chain_does_not_exhaust_the_stack():
    n = 20_000
    assert components_in_order([[i + 1] if i + 1 < n else [] for i in range(n)])[0] == [n - 1]


def test_matching_is_a_permutation_where_one_exists_and_marks_what_is_left_over():
    assert sorted(match([[0, 1], [0], [1, 2]], 3)) == [0, 1, 2]
    assert match([[0], [0]], 2).count(-1) == 1
    assert match([[], [0]], 1)[0] == -1


def test_reachable_follows_arrows_only():
    assert reachable(0, [[1], [2], [], [0]]) == {0, 1, 2}
