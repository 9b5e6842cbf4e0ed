"""Rooms in 3D: the model that a page gets, and in a real browser that what opens does."""

import base64
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from remqa_data.browse.dataset import BrowsedDataset, RoomKey
from remqa_data.browse.export import write_site
from remqa_data.browse.models import NO_MODEL, carried, hung, model_script
from remqa_data.browse.site import Site
from remqa_data.opencv import cv2
from tests.helpers.hostile_dataset import Tab
from tests.helpers.room_records import thing

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def rooms(small_rooms: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    """Where the pages of two real rooms lie as files."""
    out = tmp_path_factory.mktemp("rooms") / "site"
    write_site(Site(BrowsedDataset(small_rooms), is_static=True), out)
    return f"{out.as_uri()}/"


def first_room(root: Path) -> RoomKey:
    return min(BrowsedDataset(root).room_places)


def test_a_drawer_takes_along_what_lies_in_it_and_on_that() -> None:
    at, size = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
    objects = [
        thing("Drawer|1", at, size),
        thing("Plate|1", at, size, on="Drawer|1", kind="in"),
        thing("Mug|1", at, size, on="Plate|1"),
        thing("Pen|1", at, size, on="Mug|1", kind="in"),
        thing("Book|1", at, size, on="Table|1"),
        thing("Box|1", at, size, on="Box|2", kind="in"),
        thing("Box|2", at, size, on="Box|1", kind="in"),  # a damaged file: nothing waits for ever
    ]
    found = carried(objects)
    assert found["Drawer|1"] == ["Plate|1", "Mug|1", "Pen|1"]
    assert found["Box|1"] == ["Box|2", "Box|1"]
    assert "Table|1" not in found


def test_what_hangs_on_walls_is_told() -> None:
    at, size = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
    objects = [thing(name, at, size) for name in ("Window|1", "Mug|1", "Painting|1", "Cabinet|1")]
    assert hung(objects) == ["Window|1", "Painting|1"]


def test_a_model_is_a_script_with_binary_gltf_and_a_damaged_room_is_none(small_rooms: Path) -> None:
    dataset = BrowsedDataset(small_rooms)
    script = model_script(dataset.scene_json(first_room(small_rooms)), "here")
    start, end = b'const MODEL = "', b'";\n'
    assert script.startswith(start)
    assert script.endswith(end)
    assert base64.b64decode(script[len(start) : -len(end)], validate=True).startswith(b"glTF")
    assert model_script('{"name": "</script>"}', "here") == NO_MODEL


def test_files_have_the_first_arrangement_of_each_room_and_a_server_all(small_rooms: Path) -> None:
    dataset = BrowsedDataset(small_rooms)
    keys = sorted(dataset.room_places)
    firsts = {min(key for key in keys if key.scene == scene) for scene in {key.scene for key in keys}}
    assert Site(dataset, is_static=True).scope.models == firsts
    served = Site(dataset)
    assert served.scope.models == set(keys)
    assert all(served.get(f"r/{key.slug}.html") is not None for key in keys)
    assert served.get("r/nothing.html") is None
    assert served.get(f"r/{keys[0].slug}.svg") is None


def opened(tab: Tab, address: str) -> None:
    tab.page.goto(address)
    tab.page.wait_for_selector("body[data-loaded]", timeout=60_000)
    still(tab)


def still(tab: Tab) -> None:
    """Wait until what was asked for has moved and been drawn."""
    tab.page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    tab.page.wait_for_selector("#stage[data-moving='0']", timeout=60_000)


def pixels(tab: Tab) -> Any:
    shot = np.frombuffer(tab.page.locator("#room").screenshot(), np.uint8)
    return cv2.imdecode(shot, cv2.IMREAD_COLOR).astype(int)


def changed(before: Any, after: Any) -> float:
    """Share of pixels that differ."""
    return float((np.abs(before - after).max(axis=2) > 20).mean())


def test_what_opens_opens_and_closes_again(tab: Tab, rooms: str, small_rooms: Path) -> None:
    opened(tab, f"{rooms}r/{first_room(small_rooms).slug}.html")
    count = int(tab.page.evaluate("document.body.dataset.loaded"))
    assert count == tab.page.locator("#openable button").count() >= 1
    assert tab.page.locator("#state").is_hidden()
    closed = pixels(tab)
    assert closed.std() > 20, "something is drawn"
    door = tab.page.locator("#openable button", has_text="Fridge").first
    door.focus()
    tab.page.keyboard.press("Enter")
    still(tab)
    assert door.get_attribute("aria-pressed") == "true"
    tab.page.locator("#room").scroll_into_view_if_needed()
    assert changed(closed, pixels(tab)) > 0.002
    door.click()
    still(tab)
    tab.page.locator("#room").scroll_into_view_if_needed()
    assert changed(closed, pixels(tab)) < 0.0005
    assert tab.events == []
    every = tab.page.locator("#all")
    every.click()
    assert every.text_content() == "Close all"
    door.click()  # one of them is closed again
    assert (every.text_content(), every.get_attribute("aria-pressed")) == ("Open all", "false")


def test_the_room_turns_by_keys_and_fits_a_phone(tab: Tab, rooms: str, small_rooms: Path) -> None:
    tab.page.set_viewport_size({"width": 400, "height": 800})
    opened(tab, f"{rooms}r/{first_room(small_rooms).slug}.html")
    assert tab.page.evaluate("document.documentElement.scrollWidth") <= 400
    before = pixels(tab)
    tab.page.locator("#room").focus()
    for _ in range(4):
        tab.page.keyboard.press("ArrowLeft")
    still(tab)
    assert changed(before, pixels(tab)) > 0.05
    assert tab.events == []


def test_a_damaged_room_is_told_of(tab: Tab, served: str) -> None:
    tab.page.goto(f"{served}r/Kitchen1-c0.html")
    tab.page.wait_for_selector("#state.bad")
    assert "cannot be read" in tab.page.locator("#state").text_content()
    assert tab.events == []
