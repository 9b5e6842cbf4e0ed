"""The table that shows recorded and sampled rooms side by side, on figures made up here."""

from remqa_data.floorplans.sampled.naming import ROOM_TYPES
from remqa_data.generators.figures.layout_statistics import BEGIN, END, RoomFigures, side_by_side, write_table

SMALL = RoomFigures(10, 5, 12.0, 80, 6, 0, 2, 1)
LARGE = RoomFigures(30, 9, 16.0, 100, 8, 4, 4, 0)


def test_medians_means_and_their_difference() -> None:
    recorded = {room_type: [SMALL, SMALL, LARGE] for room_type in ROOM_TYPES}
    sampled = {room_type: [LARGE, LARGE, SMALL] for room_type in ROOM_TYPES}
    lines = side_by_side(recorded, sampled).splitlines()
    assert "| kitchen | objects | 10 (16.7) | 30 (23.3) | +200% |" in lines
    assert "| bathroom | area (m²) | 12 (13.3) | 16 (14.7) | +33% |" in lines
    assert "| bedroom | drawers | 0 (1.3) | 4 (2.7) |  |" in lines, "there is no share of nothing"
    assert len(lines) == 2 + 4 * 8


def test_the_table_replaces_the_old_one_and_nothing_else(tmp_path) -> None:
    page = tmp_path / "page.md"
    page.write_text(f"before\n{BEGIN}old\n{END}after\n", encoding="utf-8")
    write_table(page, "new\n")
    assert page.read_text(encoding="utf-8") == f"before\n{BEGIN}new\n{END}after\n"
