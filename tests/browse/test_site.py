"""What lies at which address, without a browser."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from remqa_data.browse.answers import given_answers, read_answers
from remqa_data.browse.dataset import BrowsedDataset, RoomKey, slug
from remqa_data.browse.export import write_site
from remqa_data.browse.site import Site
from remqa_data.cli import app
from remqa_data.errors import OutputError, SubmissionError
from remqa_data.opencv import cv2
from remqa_data.storage.card import write_card
from remqa_data.storage.manifest import make_manifest
from remqa_data.storage.parts import Parts, assemble, count_questions, finish
from remqa_data.tables.images import encode_labels
from tests.helpers.dataset_rows import HEIGHT, WIDTH, images, scene_rows
from tests.helpers.forgeries import Copy
from tests.helpers.hostile_dataset import HOSTILE, HOSTILE_ID, QUESTIONS
from tests.helpers.submissions import written


def text(site: Site, address: str, **query: str) -> str:
    found = site.get(address, query)
    assert found is not None
    return found.body.decode()


def browse(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["browse", *map(str, arguments)])


def decoded(data: bytes) -> Any:
    return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)


def test_stored_pictures_are_given_out_bit_for_bit(site: Site) -> None:
    found = site.get("p/q/Kitchen1-q3/start.jpg")
    assert found.body == images(3)[0].bytes
    assert found.media_type == "image/jpeg"


def test_pictures_are_made_of_depth_and_objects(site: Site) -> None:
    for name in ("start-depth.jpg", "end-objects.jpg"):
        assert decoded(site.get(f"p/q/Kitchen1-q3/{name}").body).shape == (HEIGHT, WIDTH, 3)
    nearness = decoded(site.get("p/q/Kitchen1-q3/start-depth.jpg").body).astype(float).sum(axis=2)
    assert nearness[0, 0] < nearness.mean() / 2, "what was not seen is black"


def test_what_the_walk_has_not_seen_of_the_map_can_be_seen_through(site: Site) -> None:
    alpha = decoded(site.get("p/w/Kitchen1-c0/map.png").body)[..., 3]
    stored = np.arange(12).reshape(3, 4)
    assert np.array_equal(alpha > 0, (stored >= 1) & (stored <= 2)), "0 is unseen; there are two labels"


@pytest.mark.parametrize(
    "address",
    ["nothing", "q/nothing.html", "w/x.html", "p/q/Kitchen1-q3/x.jpg", "p/w/Kitchen1-c0/f99.jpg", "p/w/Kitchen1-c0/f-1.jpg",
     "../manifest.json", "style/../site.py", "style/site.py", "p/q/../../../etc/passwd"],
)  # fmt: skip
def test_where_nothing_lies_nothing_is_found(site: Site, address: str) -> None:
    assert site.get(address) is None


def test_filters_and_pages_of_the_list(site: Site) -> None:
    def count(**query: str) -> int:
        return int(re.search(r'id="count">(\d+)', text(site, "index.html", **query))[1])

    assert count() == QUESTIONS
    assert count(kind="COUNTING") == 20
    assert count(kind="COUNTING", answer="2") == 19, "one has a hostile answer"
    assert count(kind="COUNTING", answer="yes") == 0
    assert count(q="KITCHEN1-Q12") == 1
    assert count(q="toaster drawer") == QUESTIONS - 1
    assert count(scene=HOSTILE) == 0
    for page in ("0", "-1", "99999999999", "x", "²"):
        assert count(page=page) == QUESTIONS
    assert text(site, "index.html", page="3").count('class="card"') == QUESTIONS - 48
    assert text(site, "index.html", page="999").count('class="card"') == QUESTIONS - 48


def test_a_question_names_its_group_and_their_answers(site: Site) -> None:
    page = text(site, "q/Kitchen1-q2.html")
    assert 'href="Kitchen1-q3.html"' in page
    assert "No question" not in page


def test_every_object_of_a_view_and_every_colour_of_a_map_is_told(hostile: Path, tmp_path: Path) -> None:
    copy, names = Copy(hostile, tmp_path / "copy"), [f"Mug|{number}" for number in range(20)]
    picture = vars(encode_labels(np.arange(1, 21, dtype=np.uint16).reshape(4, 5)))
    questions, rooms = copy.rows("questions"), copy.rows("scenes")
    questions[3] |= {"object_ids": names, "start_instances": picture}
    rooms[0] |= {"map_2d": picture, "semantic_map": rooms[0]["semantic_map"] | {"labels": names}}
    copy.store("questions", questions)
    copy.store("scenes", rooms)
    site = Site(BrowsedDataset(copy.root))
    assert "<summary>20 objects</summary>" in text(site, "q/Kitchen1-q3.html")
    for address in ("q/Kitchen1-q3.html", "w/Kitchen1-c0.html"):
        assert "<summary>Colours of the map</summary>" in text(site, address)
        assert all(f"</svg>{name}</li>" in text(site, address) for name in names)


def test_the_target_is_framed_without_a_script(site: Site) -> None:
    assert f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" aria-hidden="true"><rect x="8" y="4"' in text(
        site, "q/Kitchen1-q3.html"
    )


def test_rooms_are_in_natural_order_with_the_questions_that_have_a_page(tmp_path: Path) -> None:
    parts = Parts(tmp_path / "rooms", {"seed": 0})
    made = [
        parts.write(name, scene_rows(name, "test", questions=2), {"refused": {}})
        for name in ("FloorPlan10", "FloorPlan2")
    ]
    manifest = make_manifest(assemble(parts, made, 1), seed=0, config={}, questions=count_questions(made), refused={})
    write_card(tmp_path / "rooms", manifest)
    finish(parts.storage, manifest)
    for limit, counts in ((None, ["2 questions", "2 questions"]), (3, ["2 questions", "1 question"])):
        page = text(Site(BrowsedDataset(tmp_path / "rooms"), is_static=True, limit=limit), "rooms.html")
        assert re.findall(r'"question">(\w+)<', page) == ["FloorPlan2", "FloorPlan10"]
        assert re.findall(r"\d+ questions?(?= ·)", page) == counts


def test_names_that_cannot_be_files_get_others(site: Site) -> None:
    assert re.fullmatch("x-[0-9a-f]{20}", slug(HOSTILE_ID))
    assert f"<h1>{HOSTILE}" not in text(site, f"q/{slug(HOSTILE_ID)}.html")
    addresses = list(site.addresses())
    assert addresses
    assert all(re.fullmatch(r"[\w./-]+", address) and ".." not in address for address in addresses)


class Nesting(HTMLParser):
    """Counts headings, and notes in what elements some others lie."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.headings, self.around_details = 0, set[str]()

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self.headings += tag == "h1"
        if tag == "details":
            self.around_details.add(self.open[-1])
        if tag not in ("meta", "link", "img", "input", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag in self.open:
            while self.open.pop() != tag:
                pass


@pytest.mark.slow
def test_each_page_has_one_heading_and_details_lie_where_they_may(site: Site) -> None:
    pages = [address for address in site.addresses() if address.endswith(".html")]
    seen = set()
    for address in pages:
        nesting = Nesting()
        nesting.feed(text(site, address))
        assert nesting.headings == 1, address
        seen |= nesting.around_details
    assert "figure" not in seen
    assert "figcaption" in seen


@pytest.mark.slow
def test_an_export_has_every_address_it_links_to_and_index_last(hostile: Path, tmp_path: Path) -> None:
    site, out = Site(BrowsedDataset(hostile), is_static=True, limit=7), tmp_path / "site"
    written_last = list(site.addresses())[-1]
    assert written_last == "index.html"
    assert write_site(site, out) == sum(path.is_file() for path in out.rglob("*"))
    assert text(site, "index.html").count('class="card"') == 7
    pages = {page: re.findall(r'(?:href|src)="([^"?#]+)', page.read_text()) for page in out.rglob("*.html")}
    links = [(page, link) for page, found in pages.items() for link in found]
    assert links
    for page, link in links:
        assert (page.parent / link).resolve().is_relative_to(out.resolve()), link
        assert (page.parent / link).is_file(), (page, link)
    with pytest.raises(OutputError, match="not an empty folder"):
        write_site(site, out)


def test_answers_of_agents_are_shown_beside_the_right_one(hostile: Path, tmp_path: Path) -> None:
    rows = [{"question_id": "Kitchen1-q0", "answer": " Yes "}, {"question_id": "Kitchen1-q1", "answer": HOSTILE}]
    agents = read_answers([written(tmp_path / "a.jsonl", "qa", rows, agent=HOSTILE)], hostile)
    assert [one.is_right for one in given_answers(agents, "Kitchen1-q0", "yes")] == [True]
    assert [one.is_right for one in given_answers(agents, "Kitchen1-q1", "2")] == [False]
    assert given_answers(agents, "Kitchen1-q2", "no") == []
    site = Site(BrowsedDataset(hostile), agents)
    assert "&lt;img src=x" in text(site, "q/Kitchen1-q1.html")
    assert "<img src=x" not in text(site, "q/Kitchen1-q1.html")
    assert "Nobody handed in anything" in text(site, "q/Kitchen1-q2.html")
    with pytest.raises(SubmissionError, match="referring expressions"):
        read_answers([written(tmp_path / "b.jsonl", "rec", [])], hostile)


def test_steps_are_counted_as_when_they_are_scored(hostile: Path, tmp_path: Path) -> None:
    row = {"question_id": "Kitchen1-q0", "actions": ["MoveAhead", "RotateLeft", "Done"]}
    agents = read_answers([written(tmp_path / "a.jsonl", "nav", [row])], hostile)
    assert [one.steps for one in given_answers(agents, "Kitchen1-q0", "yes")] == [2]


@pytest.mark.parametrize(
    ("names", "header", "said"),
    [
        (["Kitchen1-q0"], {"dataset": "0" * 64}, "the predictions are for dataset '0000000000000000', not"),
        (["Kitchen1-q0"], {"split": "train"}, "line 1, field split: the dataset has no split 'train'"),
        (["Kitchen1-q0", "Kitchen1-q0"], {}, "line 3, field question_id: 'Kitchen1-q0' is there twice"),
        (["Kitchen1-q99"], {}, "line 2, field question_id: 'Kitchen1-q99' is not in split 'test'"),
    ],
)
def test_answers_that_would_not_be_scored_are_not_shown(
    hostile: Path, tmp_path: Path, names: list[str], header: dict[str, str], said: str
) -> None:
    path = written(tmp_path / "a.jsonl", "qa", [{"question_id": name, "answer": "yes"} for name in names], **header)
    done = browse(hostile, "--export", tmp_path / "site", "--submission", path)
    assert (done.exit_code, done.output.count("\n")) == (2, 1), done.output
    assert said in done.output


def test_the_audit_that_recount_wrote_is_shown(hostile: Path, tmp_path: Path) -> None:
    (tmp_path / "audit.csv").write_text("what,asked,measured,holds\nEXISTENCE: right by revealed,<= 0.52,0.501,True\n")
    out = tmp_path / "site"
    done = browse(hostile, "--export", out, "--limit", 1, "--audit", tmp_path / "audit.csv")
    assert done.exit_code == 0, done.output
    page = (out / "statistics.html").read_text()
    assert "EXISTENCE: right by revealed" in page
    assert "0.501" in page
    (tmp_path / "bad.csv").write_text("a,b\n1,2\n")
    done = browse(hostile, "--export", tmp_path / "other", "--audit", tmp_path / "bad.csv")
    assert done.exit_code == 2
    assert "write it with: remqa-data recount DIR --csv bad.csv" in done.output


@pytest.mark.parametrize(("table", "said"), [("scenes", "room Kitchen1-c0"), ("questions", "question Kitchen1-q0")])
def test_what_is_there_twice_is_refused_before_anything_is_shown(
    hostile: Path, tmp_path: Path, table: str, said: str
) -> None:
    copy = Copy(hostile, tmp_path / "copy")
    copy.store(table, copy.rows(table) * 2)
    for options in (("--port", "0"), ("--export", tmp_path / "site")):
        done = browse(copy.root, *options)
        assert done.exit_code == 2
        assert f"{said} is there twice" in done.output
    assert not (tmp_path / "site").exists()


def test_the_command_says_in_one_line_what_is_wrong(hostile: Path, tmp_path: Path) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "x").touch()
    for arguments, said in (
        ((tmp_path / "none", "--export", tmp_path / "a"), "no such folder"),
        ((hostile, "--export", tmp_path / "full"), "not an empty folder"),
        ((hostile, "--export", hostile), "which holds nothing else; give another place"),
        ((hostile, "--export", hostile / "site"), "which holds nothing else; give another place"),
        ((hostile, "--host", ""), "--host is empty"),
        ((hostile, "--port", "0", "--export", tmp_path / "a"), "--host and --port are for pages that are served"),
        ((hostile, "--submission", tmp_path / "x.jsonl", "--export", tmp_path / "a"), "no such file"),
    ):
        done = browse(*arguments)
        assert done.exit_code == 2
        assert said in done.output
        assert "Traceback" not in done.output


def test_without_the_packages_the_extra_is_named(hostile: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "uvicorn", None)
    monkeypatch.setitem(__import__("sys").modules, "starlette", None)
    done = browse(hostile)
    assert done.exit_code == 2
    assert "pip install 'remqa-data[browse]'" in done.output


def test_what_exporting_says_to_programs(hostile: Path, tmp_path: Path) -> None:
    done = browse(hostile, "--export", tmp_path / "site", "--limit", 2, "--json")
    said = json.loads(done.output)
    assert said["questions"] == 2
    assert said["files"] == sum(path.is_file() for path in (tmp_path / "site").rglob("*"))


@pytest.mark.slow
def test_the_map_that_grows_ends_as_the_stored_one_but_for_millimetres(one_room: Path) -> None:
    dataset = BrowsedDataset(one_room)
    site = Site(dataset)
    assert dataset.walk_places
    for key, places in dataset.walk_places.items():
        names = [f"p/w/{key.slug}/m{number}.png" for number in range(len(places))]
        grown = [decoded(site.get(name).body) for name in names]
        stored = decoded(site.get(f"p/w/{key.slug}/map.png").body)
        differs = np.any(grown[-1] != stored, axis=2)  # depth is in millimetres, and the smallest things are not listed
        assert differs.mean() < 0.03
        seen = [int((picture[..., 3] > 0).sum()) for picture in grown]
        assert seen == sorted(seen)
        assert seen[0] < seen[-1]


@pytest.mark.slow
def test_programs_of_real_questions_end_with_the_evidence(one_room: Path) -> None:
    from remqa_data.browse.programs import graph_of, steps_in_words
    from remqa_data.browse.room_map import RoomMap, way

    dataset = BrowsedDataset(one_room)
    assert dataset.index.num_rows > 0
    for row in range(dataset.index.num_rows):
        asked = dataset.question(row)
        room = dataset.room(RoomKey(asked["scene"], asked["configuration"]))
        steps = steps_in_words(asked["program"], graph_of(room.objects))
        assert set(steps[-2].found) == set(asked["answer_ids"])
        assert steps[-1].found is None
        frame = RoomMap.of(room)
        points = way(room, frame, asked["initial_pose"], asked["actions"])
        assert points[0] == frame.point(*asked["initial_pose"]["position"][:2])
        ends = [frame.point(*pose["position"][:2]) for pose in asked["goal_poses"]]
        assert any(np.allclose(points[-1], end, atol=0.01) for end in ends)
