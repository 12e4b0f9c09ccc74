"""The data sheet: what it says, and that it can be read."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import msgspec
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

from seacrane import design
from seacrane.design import Crane, chart, geometry, mesh, sheet
from seacrane.results import charts
from seacrane.results.data_sheet import pages
from seacrane.units import deg, kN


def words(page: Figure) -> list[str]:
    return [text.get_text() for text in page.texts]


@pytest.fixture(scope="module")
def offshore() -> list[Figure]:
    return pages(sheet.content(design.load("offshore-100t"), "0123"))


def test_every_page_says_that_it_is_not_certified_and_of_which_design_it_is(offshore: list[Figure]) -> None:
    for page in offshore:
        assert "NOT A CERTIFIED LOAD CHART" in words(page)
        assert any("Not a certified load chart. Design SHA-256 0123" in text for text in words(page))


def test_the_table_has_the_load_of_each_radius_and_mode_with_what_governs(offshore: list[Figure]) -> None:
    crane = design.load("offshore-100t")
    said = words(offshore[1])
    letters = dict(item.split(" ", 1)[::-1] for item in next(t for t in said if "slew moment" in t).split("   "))
    table = said[said.index("radius") :]
    modes = [mode.name for mode in chart.modes(crane)]
    assert table[1 : 1 + len(modes)] == modes
    cells = iter(table[1 + len(modes) :])
    for rows in zip(*(chart.curve(crane, mode) for mode in chart.modes(crane)), strict=True):
        assert next(cells) == f"{rows[0].radius:.1f}"
        for row in rows:
            assert [next(cells), next(cells)] == [f"{row.swl / 1e3:.1f}", letters[row.governs]]


def wordy() -> Crane:
    """A crane whose names and texts are as long as they may be."""
    crane = design.load("a-frame-30t")
    cylinders = tuple(msgspec.structs.replace(c, name=f"{c.name} ".ljust(100, "n")) for c in crane.cylinders)
    text = "A sentence of some length on a crane, as its designer thought fit to write. " * 30
    return msgspec.structs.replace(
        crane,
        name="n" * 100,
        about=text,
        cylinders=cylinders,
        sources=(design.Source(of="a", kind="derived", note=text),),
    )


@pytest.mark.parametrize("of", [*design.names(), wordy])
def test_no_words_leave_the_page_or_lie_over_others(of: str | Callable[[], Crane]) -> None:
    crane = design.load(of) if isinstance(of, str) else of()
    for page in pages(sheet.content(crane, "0" * 64)):
        renderer = FigureCanvasAgg(page).get_renderer()
        boxes = [(text.get_text(), text.get_window_extent(renderer)) for text in page.texts if text.get_text()]
        for said, box in boxes:
            assert page.bbox.x0 <= box.x0 < box.x1 <= page.bbox.x1, said
            assert page.bbox.y0 <= box.y0 < box.y1 <= page.bbox.y1, said
        for (one, a), (other, b) in itertools.combinations(boxes, 2):
            across, up = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
            assert across <= 1 or up <= 1, (one, other)


def test_a_sheet_of_much_has_as_many_pages_as_it_needs() -> None:
    crane = design.load("a-frame-30t")
    few = sheet.content(crane, "0")
    many = sheet.content(msgspec.structs.replace(crane, sources=crane.sources * 60), "0")
    assert len(pages(many)) > len(pages(few)) == 3
    assert sum(words(page).count("Sources") for page in pages(many)) == len(pages(many)) - 2


@pytest.mark.parametrize("name", design.names())
def test_the_side_view_shows_the_crane_where_it_is_and_no_hollow(name: str) -> None:
    crane = design.load(name)
    posture = sheet.half_way(crane)
    seen = sheet.side_view(crane, posture)
    x, _, z = geometry.tip(crane, posture)
    assert seen[-1].edges[-1, 1] == pytest.approx([x, z])
    for c in crane.cylinders:
        places = np.concatenate([shape.covers.reshape(-1, 2) for shape in seen if len(shape.covers) == 2])
        frames = geometry.frames(crane, posture)
        for pin in (c.base, c.eye):
            at = frames[pin.link].point((pin.x, 0.0, pin.z))[[0, 2]]
            assert np.linalg.norm(places - at, axis=1).min() < c.bore
    whole = sum(len(mesh.mesh(part).faces) for link in design.standard.furnished(crane).links for part in link.parts)
    assert sum(len(shape.covers) for shape in seen) < whole + 4 * len(crane.cylinders)
    low = min(shape.edges.min() for shape in seen)
    assert low > -crane_size(crane)


@pytest.mark.parametrize("name", design.names())
@pytest.mark.parametrize("mode", ["harbour", "hs2.0"])
def test_the_colours_of_a_section_tell_loads_apart_where_the_crane_works(name: str, mode: str) -> None:
    crane = design.load(name)
    where = design.workspace.section(crane, 60)
    loads = design.workspace.loads(crane, where, chart.mode(crane, mode)) / 1e3
    figure = charts.load_section(where.radius, where.height, loads * 1e3)
    colours = next(item for item in figure.axes[0].collections if isinstance(item, QuadMesh))
    low, high = colours.get_clim()
    lifted = loads[loads > 0]
    assert low == 0
    assert np.mean(lifted > 1.1 * high) < 0.1
    assert high <= 1.06 * lifted.max()


def crane_size(crane: Crane) -> float:
    return 2.0 * max(abs(value) for value in design.workspace.extent(crane))


def test_the_conditions_name_what_is_taken_for_granted_and_what_is_left_out() -> None:
    crane = design.load("offshore-100t")
    hoist = msgspec.structs.replace(crane.hoist, falls=4, speed=0.5, hook_mass=1200.0, sheave_efficiency=0.98)
    rating = msgspec.structs.replace(crane.rating, heel=3 * deg, heeling_moment=20e3 * kN)
    told = "\n".join(chart.conditions(msgspec.structs.replace(crane, hoist=hoist, rating=rating)))
    for words in (
        "below the hook block of 1.2 t, on 4 falls with 0.98 per sheave",
        "2 x boom_cylinder at 280 bar, 2 x jib_cylinder at 280 bar",
        "dynamic factor 1.1",
        "hook v_L 0.125 m/s",
        "hs1.0: the hook at 0.12 m/s is slower than the 0.20 m/s of EN 13852-1",
        "Heel 3 deg and trim 0 deg",
        "No limit is given for the slewing gear, the structure, the load moment: none is checked",
        "Left out: wind, side loads of the structure",
    ):
        assert words in told
