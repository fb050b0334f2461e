"""Large images are cut into tiles, and what is found in them is put together again."""

from typing import NamedTuple, Sequence, Tuple

import pytest

from robot_vision.dnn.tiles import MAX_FOUND, merged, tiles_of


class Found(NamedTuple):
    box: Tuple[float, float, float, float]
    score: float = 0.5
    class_id: int = 0
    outline: Sequence[Tuple[float, float]] = ()


CUTS = [
    ((0, 0, 100, 80), 1, 1, 0.2, [(0, 0, 100, 80)]),
    ((0, 0, 100, 80), 1, 2, 0.0, [(0, 0, 50, 80), (50, 0, 50, 80)]),
    ((10, 20, 90, 60), 1, 2, 0.2, [(10, 20, 50, 60), (50, 20, 50, 60)]),
    ((0, 0, 100, 100), 2, 1, 0.0, [(0, 0, 100, 50), (0, 50, 100, 50)]),
    ((0, 0, 3, 1), 4, 5, 0.0, [(0, 0, 1, 1), (1, 0, 1, 1), (2, 0, 1, 1)]),
]


@pytest.mark.parametrize("region, rows, columns, overlap, tiles", CUTS)
def test_tiles_cover_the_region(region, rows, columns, overlap, tiles):
    assert tiles_of(region, rows, columns, overlap) == tiles


@pytest.mark.parametrize("side", [1, 2, 7, 640, 641, 1279])
@pytest.mark.parametrize("count", [1, 2, 3, 8])
@pytest.mark.parametrize("overlap", [0.0, 0.25, 0.9])
def test_tiles_leave_nothing_out_and_overlap_as_much_as_they_must(side, count, overlap):
    tiles = tiles_of((5, 7, side, side), count, count, overlap)
    row = [tile for tile in tiles if tile[1] == 7]
    assert row[0][0] == 5 and row[-1][0] + row[-1][2] == 5 + side
    assert {tile[2:] for tile in tiles} == {row[0][2:]} and len(tiles) == len(row) ** 2
    for (left, _, width, _), (right, *_) in zip(row, row[1:]):
        assert left + width - right >= overlap * width - 1.0


LEFT, RIGHT = (0, 0, 60, 100), (40, 0, 60, 100)
REGION = (0, 0, 100, 100)


def together(*found, iou=0.5, class_agnostic=False, count=300):
    return merged(found, REGION, iou, class_agnostic, count)


def test_what_two_tiles_see_is_one_object():
    sure, other = Found((42, 10, 58, 30), 0.9), Found((43, 10, 58, 31), 0.8)
    assert together((other, LEFT), (sure, RIGHT)) == [sure]


def test_what_an_edge_cuts_gives_way_to_the_whole():
    """The part is surer, and a small share of the whole."""
    part, whole = Found((42, 10, 60, 20), 0.95), Found((42, 10, 98, 20), 0.6)
    assert together((part, LEFT), (whole, RIGHT)) == [whole]


def test_parts_that_no_tile_has_as_a_whole_stay():
    left, right = Found((5, 10, 60, 20), 0.9), Found((40, 10, 95, 20), 0.8)
    assert together((left, LEFT), (right, RIGHT)) == [left, right]


def test_a_small_thing_before_a_large_one_stays_in_the_same_tile():
    small, large = Found((10, 10, 20, 20), 0.9), Found((5, 5, 35, 35), 0.8)
    assert together((small, LEFT), (large, LEFT)) == [small, large]


@pytest.mark.parametrize("corners", [((0, 0), (1, 0), (1, 1), (0, 1)), ()])
def test_a_small_thing_before_a_large_one_leaves_its_pieces(corners):
    """However sure or unsure it is. A piece of it inside of it goes."""

    def made(left, top, right, bottom, score):
        sides = right - left, bottom - top
        outline = [(left + x * sides[0], top + y * sides[1]) for x, y in corners]
        return Found((left, top, right, bottom), score, outline=outline)

    small = made(43, 20, 57, 60, 0.3)
    left, right = made(5, 10, 60, 90, 0.9), made(40, 10, 95, 90, 0.8)
    piece = made(40, 30, 48, 50, 0.5)
    found = together((left, LEFT), (right, RIGHT), (small, LEFT), (small, RIGHT), (piece, RIGHT))
    assert found == [left, right, small]


def test_the_edge_of_the_region_cuts_nothing():
    sure, other = Found((42, 0, 58, 30), 0.9), Found((43, 3, 58, 30), 0.8)
    assert together((other, LEFT), (sure, RIGHT)) == [sure]


def test_what_the_decoder_of_a_tile_has_kept_is_not_compared_again():
    """Whether boxes of one tile may overlap is the network's matter, or that of its decoder."""
    sure, other = Found((10, 10, 30, 30), 0.9), Found((12, 10, 30, 30), 0.8)
    assert together((other, LEFT), (sure, LEFT)) == [sure, other]


def turned(x, y, score):
    """A slim box from (x, y) to 20 px below and to the right."""
    corners = [(x, y), (x + 22, y + 20), (x + 20, y + 22), (x - 2, y + 2)]
    return Found((x - 2, y, x + 22, y + 22), score, outline=corners)


def test_turned_things_are_compared_by_their_outlines():
    one, beside = turned(42, 10, 0.9), turned(47, 10, 0.8)
    assert together((one, LEFT), (beside, RIGHT)) == [one, beside]
    same = turned(42.2, 10, 0.8)
    assert together((one, LEFT), (same, RIGHT)) == [one]


def test_classes_are_apart_unless_told_otherwise():
    one, other = Found((42, 10, 58, 30), 0.9, 0), Found((42, 10, 58, 30), 0.8, 1)
    assert together((one, LEFT), (other, RIGHT)) == [one, other]
    assert together((one, LEFT), (other, RIGHT), class_agnostic=True) == [one]


def test_of_very_many_the_surest_count():
    many = [(Found((x, 10, x + 1, 11), x / 10000), LEFT) for x in range(9000)]
    kept = merged(many, REGION, 0.45, False, 10000)
    assert [one.box[0] for one in kept] == list(range(8999, 8999 - MAX_FOUND, -1))


def test_the_surest_come_first_and_only_so_many():
    found = [Found((20 * k, 0, 20 * k + 10, 10), 0.1 * k) for k in range(1, 4)]
    assert together(*((one, REGION) for one in found), count=2) == [found[2], found[1]]
    assert together() == []
