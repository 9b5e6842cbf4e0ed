"""The pages in a real browser, served and from disk: filters, keys, the slider; hostile texts are texts."""

from pathlib import Path

import pytest

from remqa_data.browse.dataset import slug
from tests.helpers.hostile_dataset import HOSTILE, HOSTILE_ID, QUESTIONS, Tab

pytestmark = pytest.mark.slow

PAGES = (
    "index.html",
    "rooms.html",
    "statistics.html",
    "q/Kitchen1-q3.html",
    f"q/{slug(HOSTILE_ID)}.html",
    "w/Kitchen1-c0.html",
)


@pytest.fixture(params=["served", "exported"])
def start(request: pytest.FixtureRequest) -> str:
    """Where the pages begin: at a server, and on disk."""
    found = request.getfixturevalue(request.param)
    return f"{found.as_uri()}/" if isinstance(found, Path) else found


def shown(tab: Tab) -> list[str]:
    return tab.page.locator("#cards > li:visible .question").all_text_contents()


@pytest.mark.parametrize("width", [400, 1280])
def test_every_page_opens_without_complaints_and_fits_a_phone_and_a_desk(tab: Tab, start: str, width: int) -> None:
    tab.page.set_viewport_size({"width": width, "height": 900})
    for name in PAGES:
        tab.page.goto(start + name, wait_until="load")
        assert tab.page.evaluate("document.documentElement.scrollWidth") <= width, name
        for one in tab.page.locator("main img:visible").all()[:6]:
            one.scroll_into_view_if_needed()
            one.evaluate("image => image.decode()")
        assert tab.page.evaluate("getComputedStyle(document.body).marginTop") == "0px", "the style sheet is used"
        assert tab.page.evaluate("parseFloat(getComputedStyle(document.querySelector('main')).fontSize)") >= 16
    assert tab.events == []


def test_hostile_texts_show_as_texts(tab: Tab, start: str) -> None:
    tab.page.goto(start + f"q/{slug(HOSTILE_ID)}.html")
    assert HOSTILE in tab.page.locator("h1").text_content()
    assert tab.page.title() == HOSTILE
    assert tab.page.locator(".actions code").text_content() == HOSTILE
    tab.page.goto(start + "index.html")
    assert HOSTILE in shown(tab)
    tab.page.goto(start + "w/Kitchen1-c0.html#1")
    assert HOSTILE.split("|")[0] in tab.page.locator("#new li").all_text_contents()
    assert tab.page.evaluate("window.hacked") is None
    assert tab.events == []


def test_injected_scripts_would_not_run(tab: Tab, start: str) -> None:
    tab.page.goto(start + "index.html")
    tab.page.evaluate("document.body.insertAdjacentHTML('beforeend', '<img src=x onerror=\"window.hacked=1\">')")
    for _ in range(50):  # until the browser has told of it
        tab.page.wait_for_timeout(100)
        if tab.events:
            break
    assert tab.page.evaluate("window.hacked") is None
    assert any("Content Security Policy" in event for event in tab.events)


def test_filters_stand_in_the_address_which_can_be_shared(tab: Tab, start: str) -> None:
    tab.page.goto(start + "index.html")
    assert len(shown(tab)) == 24
    tab.page.select_option("select[name=kind]", "COUNTING")
    tab.page.wait_for_url("**kind=COUNTING*")
    assert tab.page.locator("#count").text_content() == str(QUESTIONS // 3)
    tab.page.fill("input[name=q]", "Beneath MUG q7")
    tab.page.press("input[name=q]", "Enter")
    tab.page.wait_for_url("**q=Beneath*")
    assert tab.page.locator("#count").text_content() == "1"
    address = tab.page.url
    tab.page.goto(start + "rooms.html")
    tab.page.goto(address)
    assert tab.page.locator("#count").text_content() == "1"
    assert tab.page.input_value("select[name=kind]") == "COUNTING"
    assert tab.page.input_value("input[name=q]") == "Beneath MUG q7"
    tab.page.go_back()
    assert tab.events == []


def test_who_comes_back_finds_the_filters_of_the_address(tab: Tab, start: str) -> None:
    tab.page.goto(start + "index.html")
    tab.page.select_option("select[name=kind]", "COUNTING")
    tab.page.wait_for_url("**kind=COUNTING*")
    tab.page.go_back()
    tab.page.wait_for_url("**/index.html")
    assert tab.page.input_value("select[name=kind]") == ""
    assert tab.page.locator("#count").text_content() == str(QUESTIONS)
    tab.page.select_option("select[name=split]", "test")
    tab.page.wait_for_url("**split=test*")
    assert "kind" not in tab.page.url


def test_the_list_is_paged(tab: Tab, start: str) -> None:
    tab.page.goto(start + "index.html")
    cards = "#cards > li:visible a"
    seen = tab.page.locator(cards).evaluate_all("links => links.map(link => link.getAttribute('href'))")
    for page in ("2", "3"):
        tab.page.click(".paging [rel=next]")
        tab.page.wait_for_url(f"**page={page}*")
        seen += tab.page.locator(cards).evaluate_all("links => links.map(link => link.getAttribute('href'))")
    assert len(seen) == len(set(seen)) == QUESTIONS
    assert not tab.page.locator(".paging [rel=next]").is_visible()


def test_nothing_found_is_said(tab: Tab, start: str) -> None:
    tab.page.goto(start + "index.html?q=zebra")
    assert tab.page.locator("#none").is_visible()
    assert shown(tab) == []


def test_the_keyboard_is_enough(tab: Tab, start: str) -> None:
    tab.page.goto(start + "index.html")
    for key in ("j", "j", "j", "k"):
        tab.page.keyboard.press(key)
    assert tab.page.locator(".chosen").count() == 1
    tab.page.keyboard.press("Enter")
    tab.page.wait_for_url("**/q/Kitchen1-q1.html")
    tab.page.keyboard.press("j")
    tab.page.wait_for_url("**/q/Kitchen1-q2.html")
    tab.page.keyboard.press("k")
    tab.page.wait_for_url("**/q/Kitchen1-q1.html")
    tab.page.goto(start + "index.html")
    tab.page.keyboard.press("/")
    tab.page.keyboard.type("jk")  # letters, while one types
    assert tab.page.input_value("input[name=q]") == "jk"
    assert tab.events == []


def test_the_slider_shows_the_walk_grow(tab: Tab, start: str) -> None:
    tab.page.goto(start + "w/Kitchen1-c0.html")
    assert tab.page.locator("#which").text_content() == "5 of 5"
    assert tab.page.locator("#nodes").text_content() == "2"
    tab.page.focus("#frame")
    tab.page.keyboard.press("Home")
    assert tab.page.locator("#which").text_content() == "1 of 5"
    assert tab.page.locator("#nodes").text_content() == "0"
    assert tab.page.locator("svg.map .dot:visible").count() == 0
    tab.page.keyboard.press("ArrowRight")
    assert tab.page.locator("#nodes").text_content() == "2"
    assert "Mug" in tab.page.locator("#new li").all_text_contents()
    assert tab.page.locator("#view").get_attribute("src").endswith("f1.jpg")
    assert tab.page.locator("#map").get_attribute("href").endswith("m1.png")
    assert tab.page.url.endswith("#1")
    tab.page.locator("#view").evaluate("image => image.decode()")
    tab.page.click("#play")
    tab.page.locator("#which", has_text="5 of 5").wait_for()
    tab.page.evaluate("location.hash = '#2'")  # as who pastes a link to another frame
    tab.page.locator("#which", has_text="3 of 5").wait_for()
    assert tab.events == []


def test_the_frame_of_the_target_lies_on_its_pixels(tab: Tab, start: str) -> None:
    tab.page.goto(start + "q/Kitchen1-q3.html")  # its box is 8, 4 to 20, 16 of 32 x 24 pixels
    picture = tab.page.locator("#start").bounding_box()
    frame = tab.page.locator(".framed rect.target").bounding_box()
    scale = picture["width"] / 32
    assert frame["x"] - picture["x"] == pytest.approx(8 * scale, abs=2)
    assert frame["y"] - picture["y"] == pytest.approx(4 * scale, abs=2)
    assert frame["width"] == pytest.approx(12 * scale, abs=4)
