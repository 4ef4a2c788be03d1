"""The lesson in a real Chromium: a student goes through it, a teacher rewrites it."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from driver import Tab, settle
from rooms import write_case

from algorithms.files.case_folder import Case
from app.page.application import make_server
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.lesson_texts import files, first_number, lesson_folder

pytestmark = pytest.mark.browser

STEPS = files(lesson_folder())
FIRST = first_number(STEPS)
LAST = FIRST + len(STEPS) - 1


def at_step(tab: Tab, number: int) -> None:
    """Wait until a step is there with its picture."""
    settle(lambda: tab.page.locator(f".mm-lesson[data-step='{number}']").count(), f"step {number}")
    settle(lambda: f"step {number} of" in tab.state, f"the map of step {number}")
    settle(lambda: tab.page.locator("svg.mm-picture").count(), f"the picture of step {number}")


def enter(tab: Tab, at: int = FIRST) -> None:
    """Open the lesson, and go on to a step."""
    tab.press("Lesson")
    at_step(tab, FIRST)
    for number in range(FIRST + 1, at + 1):
        tab.press("Next ▶")
        at_step(tab, number)


def picture(tab: Tab) -> str:
    return tab.page.locator("svg.mm-picture").first.inner_html()


def shows_what_it_should(tab: Tab) -> None:
    """A title, a text without holes, an equation and a picture that can be seen, something to try."""
    assert tab.page.locator(".mm-lesson h3").inner_text()
    for part in (".mm-equation", "svg.mm-picture"):
        box = settle(tab.page.locator(part).first.bounding_box, part)  # a picture at work is drawn anew
        assert box["width"] > 30
        assert box["height"] > 9
    dock = tab.page.locator(".mm-lesson").locator(
        "xpath=ancestor::*[contains(@class,'mantine-ScrollArea-viewport')]"
    )
    words = dock.inner_text()
    assert len(words) > 300
    assert "{" not in words
    assert "Try" in words


def test_every_step_is_shown_on_a_sample_and_leaving_puts_everything_back(tab):
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    row = "agreement (m of wall)"
    first = settle(lambda: tab.number(row), "the agreement")
    tab.move("spread", 3)
    value = settle(lambda: (now := tab.number(row)) not in ("", first) and now, "another answer")
    before, dock = tab.state, tab.page.locator("#mapmeld-ink").bounding_box()["x"]
    tab.page.mouse.click(dock + 100, 400)
    settle(lambda: tab.layer("readout"), "what is known of a place")
    enter(tab)
    assert tab.layer("readout") == []
    for number in range(FIRST, LAST + 1):
        at_step(tab, number)
        shows_what_it_should(tab)
        if number < LAST:
            tab.press("Next ▶")
    settle(lambda: "…" not in tab.page.locator(".mm-lesson").inner_text(), "all numbers")
    tab.press("◀ Back")
    at_step(tab, LAST - 1)
    tab.press("Leave")
    settle(lambda: tab.state == before, "the verdict of before")
    assert tab.mood == "accepted"
    assert tab.page.locator(".mm-lesson:visible").count() == 0
    tab.press("Result")
    settle(lambda: tab.number(row) == value, "the numbers of before")
    assert tab.layer("lesson") == []
    settle(lambda: tab.page.locator("#mapmeld-ink").bounding_box()["x"] == dock, "the dock's width of before")


def test_a_thing_to_try_moves_the_real_slider_and_is_put_back(tab):
    def intensity() -> str:
        label = tab.page.locator("label", has_text="intensity").first
        thumb = tab.page.locator(f'[id="{label.get_attribute("for")}"]').get_by_role("slider")
        return thumb.get_attribute("aria-valuenow")

    enter(tab, 2)
    first = picture(tab)
    tab.press("Set I_aug to 1")
    settle(lambda: intensity() == "1", "the slider to move")
    settle(lambda: "Fig. 13 of the paper" in tab.text, "the answer")
    settle(lambda: tab.page.locator("svg.mm-picture").count() and picture(tab) != first, "other levels")
    tab.press("Put it back")
    settle(lambda: intensity() == "100", "the slider to move back")
    settle(lambda: tab.page.locator("svg.mm-picture").count() and picture(tab) == first, "the same levels")
    assert tab.page.locator(".mm-answer").count() == 0


def test_the_first_step_goes_through_what_camera_and_laser_tell_in_four_parts(tab):
    def photo() -> int:
        return tab.page.locator("svg.mm-picture image").count()

    def equations() -> list[str]:
        return [each.get_attribute("data-equation") for each in tab.page.locator(".mm-eq").all()]

    enter(tab)
    settle(lambda: photo() == 1, "the picture with its box")
    settle(lambda: "The camera knows which way" in tab.text, "the words about the camera")
    assert "…" not in tab.page.locator(".mm-lesson").inner_text()
    assert equations() == ["pixel-bearing", "counted-bearing"]
    settle(lambda: tab.layer("lesson"), "the directions of the box on the map")
    settle(lambda: tab.mood == "idle", "the look to be over")
    tab.move("part", 1)
    settle(lambda: photo() == 2, "the window and its edges")
    settle(lambda: "What is it?" in tab.text, "the words about the detector")
    tab.move("part", 1)
    settle(lambda: "The laser knows how far" in tab.text, "the words about the laser")
    settle(lambda: equations()[:1] == ["depth-step"], "its equation")
    tab.move("part", 1)
    settle(lambda: "Why both?" in tab.text, "the reason for both")
    tab.press("Take the mean")
    settle(lambda: "too near by" in tab.page.locator("svg.mm-picture").first.text_content(), "the mean")
    settle(lambda: "The laser knows how far" in tab.text, "the part that shows it")
    tab.press("Put it back")
    settle(lambda: "too near by" not in tab.page.locator("svg.mm-picture").first.text_content(), "the centre")
    tab.press("Count pixels")
    settle(lambda: "The lens and the true centre" in tab.text, "what counting leaves out")
    settle(lambda: "The camera knows which way" in tab.text, "the part that tells of it")


def test_maps_without_a_picture_are_shown_that_of_another_sample(tab):
    tab.choose("Sample", "warehouse_r2_r1")
    settle(lambda: "warehouse_r2_r1" in tab.page.locator(".mm-title").inner_text(), "maps without a picture")
    enter(tab)
    settle(lambda: "The loaded maps come without a camera's picture" in tab.text, "that it says so")
    settle(lambda: tab.page.locator("svg.mm-picture image").count(), "the other sample's picture")
    assert "office_r2_r1" in tab.page.locator("svg.mm-picture").first.text_content()
    assert not [item for item in tab.layer("lesson") if item.get("s") == "cross"]


def test_a_dial_moves_the_picture_and_the_map(tab):
    enter(tab)
    tab.choose("Step", "12. A swarm that talks")
    at_step(tab, 12)
    first, where = picture(tab), settle(tab.swarm, "the few particles")
    tab.move("move", 4)
    settle(lambda: picture(tab) != first, "another move")
    settle(lambda: tab.swarm() != where, "the particles to follow")
    assert len(tab.layer("lesson")) > 3  # the pulls
    tab.choose("Step", "4. Every wall cell votes for its lines")
    at_step(tab, 4)
    assert {item["f"] for item in settle(lambda: tab.layer("lesson"), "the lines")} == {"scene", "map2"}


def test_each_press_counts_however_quickly_they_follow(tab):
    enter(tab)
    settle(tab.page.get_by_role("button", name="◀ Back").is_disabled, "the first step")
    for _ in range(5):
        tab.press("Next ▶")
    at_step(tab, FIRST + 5)
    for _ in range(3):
        tab.press("◀ Back")
    at_step(tab, FIRST + 2)
    tab.choose("Step", f"{LAST}. Three robots, and the way round")
    settle(tab.page.get_by_role("button", name="Next ▶").is_disabled, "the last step")
    assert tab.page.get_by_role("button", name="◀ Back").is_enabled()


def test_a_slider_of_the_panel_feeds_the_lesson_and_is_put_back(tab):
    enter(tab, 2)
    first = picture(tab)
    tab.move("spread", 5)
    settle(lambda: tab.page.locator("svg.mm-picture").count() and picture(tab) != first, "wider rings")
    tab.press("Leave")
    settle(lambda: tab.state == "Ready. Press Merge.", "the page of before")
    assert "spread" not in tab.page.locator(".mm-history").text_content()  # it never was the person's own


def test_the_lesson_goes_on_with_uploaded_maps_light_and_dark(tab, tmp_path, small_case: Case):
    tab.open_files(*write_case(tmp_path, small_case.ref, small_case.mov, small_case.observations[0]))
    settle(lambda: len(tab.listed()) == 5 and tab.state == "Ready. Press Merge.", "all five files")
    tab.page.get_by_label("Dark", exact=True).click()
    enter(tab)
    for number in range(FIRST, LAST + 1):
        at_step(tab, number)
        shows_what_it_should(tab)
        ink = tab.page.evaluate("() => getComputedStyle(document.querySelector('.mm-equation')).color")
        assert min(int(part) for part in ink.strip("rgb()").split(",")) > 150, ink  # light on dark
        if number < LAST:
            tab.press("Next ▶")
    tab.choose("Sample", "warehouse_r2_r1")
    settle(lambda: "warehouse_r2_r1" in tab.page.locator(".mm-title").inner_text(), "other maps")
    at_step(tab, LAST)


def test_what_the_sighting_buys_is_worked_out_while_one_looks_on_and_can_be_left(tab):
    def verdicts() -> int:
        words = tab.page.locator("svg.mm-picture").first.locator("text").all_text_contents()
        return sum(word.endswith((", merged", ", refused")) for word in words)

    number = LAST - 1
    enter(tab)
    tab.choose("Step", f"{number}. What the sighting buys")
    settle(lambda: " of 120 turns" in tab.text, "the first of the merges")
    assert tab.mood == "running"
    tab.press("◀ Back")
    at_step(tab, number - 1)
    settle(lambda: tab.mood == "idle", "the merge to be left")
    tab.press("Next ▶")
    at_step(tab, number)
    settle(lambda: verdicts() == 3, "all three")
    settle(lambda: tab.mood == "idle", "the end")
    where = tab.layer("best")
    tab.move("on the map", -2)
    settle(lambda: tab.layer("best") != where, "another of them on the map")
    tab.press("Leave")
    settle(lambda: tab.state == "Ready. Press Merge.", "the page of before")


def test_merge_leaves_the_lesson_and_merges(tab):
    tab.press("Instant")
    enter(tab)
    tab.press("Merge")
    tab.wait_for("accepted")
    assert tab.page.locator(".mm-lesson:visible").count() == 0


NOTHING_SMALLER = """() => {
    const sheet = document.querySelector("[data-mm-sheet]");
    return Math.min(...[...sheet.querySelectorAll("*")].map((e) => {
        const words = [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
        if (!words || !e.getBoundingClientRect().width) return 99;
        const svg = e.closest("svg.mm-picture"), px = parseFloat(getComputedStyle(e).fontSize);
        return svg ? px * svg.getScreenCTM().a : px;
    }));
}"""


def test_a_link_opens_its_place_and_a_class_sees_it_large(open_tab):
    tab = open_tab((1920, 1080))
    address = tab.page.url
    tab.page.goto("about:blank")
    tab.page.goto(f"{address}#lesson=9&sample=corridor_r3_r2")
    at_step(tab, 9)
    settle(lambda: "corridor_r3_r2" in tab.page.locator(".mm-title").inner_text(), "its sample")
    tab.press("Next ▶")
    at_step(tab, 10)
    there = "location.hash === '#lesson=10&sample=corridor_r3_r2'"
    settle(lambda: tab.page.evaluate(there), "the address to follow")
    tab.page.locator("button[data-mm-link]").click()
    settle(lambda: tab.page.locator(".mm-link figure svg").count(), "the code for phones")
    assert tab.page.get_by_label("Address of this step").input_value() == tab.page.evaluate("location.href")
    tab.page.keyboard.press("Escape")
    tab.page.keyboard.press("p")
    settle(
        lambda: tab.page.locator("svg.mm-picture").bounding_box()["width"] >= 0.6 * 1920, "the picture large"
    )
    box = tab.page.locator("svg.mm-picture").bounding_box()
    assert box["y"] + box["height"] <= 1080
    assert tab.page.evaluate(NOTHING_SMALLER) >= 24
    tab.page.keyboard.press("PageUp")
    at_step(tab, 9)
    tab.page.evaluate("location.hash = 'lesson=4'")
    at_step(tab, 4)
    tab.page.keyboard.press("Escape")
    settle(lambda: tab.page.locator("svg.mm-picture").bounding_box()["width"] < 500, "the dock of before")
    tab.press("Leave")
    settle(lambda: tab.page.evaluate("!location.hash"), "the address of before")


def test_rewritten_texts_show_at_once_and_a_broken_one_is_named(open_tab, sample: Case, tmp_path: Path):
    folder = tmp_path / "mine"
    shutil.copytree(lesson_folder(), folder)
    for path in STEPS[3:]:
        (folder / path.name).unlink()
    own = make_server(port=0, initial=sample, lesson=folder)
    try:
        tab = open_tab(at=own)
        enter(tab)
        assert f"step {FIRST} of {FIRST + 2}" in tab.state
        second = folder / STEPS[1].name
        second.write_text(
            "---\ntitle: Ein Schritt\npicture: dual\nequations: [line]\n---\nNur {walls1} Zellen."
        )
        tab.press("Next ▶")
        at_step(tab, FIRST + 1)
        settle(lambda: "Ein Schritt" in tab.text, "the new title")
        assert "Zellen." in tab.text
        third = folder / STEPS[2].name
        third.write_text("---\ntitle: Broken\npicture: nothing\n---\nText.")
        tab.press("Next ▶")
        settle(lambda: "This text cannot be read." in tab.text, "what is wrong")
        assert third.name in tab.text
        assert all(name in tab.text for name in PICTURES)
        tab.press("◀ Back")
        at_step(tab, FIRST + 1)
    finally:
        own.stop()


def test_an_exhibit_fails_as_told_and_its_cure_merges(tab):
    tab.press("Instant")
    tab.move("deviations", 2)
    settle(lambda: "up to date" in tab.state, "a setting of the person's own")
    tab.press("Museum")
    settle(lambda: "candidates.twins" in tab.text or "twins" in tab.text, "the first exhibit")
    tab.choose("Exhibit", "3. One aisle too far")
    settle(lambda: "warehouse_r3_r2" in tab.page.locator(".mm-title").inner_text(), "its maps")
    assert tab.state == "Ready. Press Merge."
    assert tab.page.get_by_role("button", name="Cure: Use the coupled window").count() == 0
    tab.press("Merge")
    settle(lambda: "Wrong: 3.6 m and 0° from the truth." in tab.text, "the failure")
    assert tab.mood == "refused"
    assert "an aisle too far" in tab.text
    tab.press("Cure: Use the coupled window")
    settle(lambda: "Cured: " in tab.text, "the cure")
    assert tab.number("window kind") == "Origin → Coupled"
    assert tab.mood == "accepted"
    tab.press("Once more, uncured")
    settle(lambda: tab.state == "Ready. Press Merge.", "the exhibit again")
    tab.press("Leave the museum")
    settle(lambda: "office_r2_r1" in tab.page.locator(".mm-title").inner_text(), "the maps of before")
    label = tab.page.locator("label", has_text="deviations").first
    thumb = tab.page.locator(f'[id="{label.get_attribute("for")}"]').get_by_role("slider")
    settle(lambda: thumb.get_attribute("aria-valuenow") == "4.5", "the person's own setting")
    assert not tab.page.get_by_text("Leave the museum").is_visible()


def test_an_exhibit_without_its_sighting_is_cured_by_it(tab):
    tab.press("Instant")
    tab.press("Museum")
    tab.choose("Exhibit", "7. The building that has its own twin")
    settle(lambda: "corridor_r2_r1" in tab.page.locator(".mm-title").inner_text(), "its maps")
    assert tab.layer("robots") == []  # nobody knows where they stood
    tab.press("Merge")
    settle(lambda: "180° from the truth. The verdict saw it." in tab.text, "the failure")
    assert tab.mood == "refused"
    tab.press("Cure: Use the sighting")
    settle(lambda: "Cured: " in tab.text, "the cure")
    assert tab.number("known") == "nothing → a sighting"
    assert tab.mood == "accepted"
    assert tab.layer("robots")
    tab.press("Leave the museum")
    settle(lambda: "office_r2_r1" in tab.page.locator(".mm-title").inner_text(), "the maps of before")


def test_the_exhibit_of_the_sighting_that_lies_is_cured_by_the_other_robots(tab):
    tab.press("Instant")
    tab.press("Museum")
    tab.choose("Exhibit", "8. The sighting that lied")
    settle(lambda: "r3 saw r4" in tab.page.locator(".mm-title").inner_text(), "its maps")
    tab.press("Merge")
    settle(lambda: "from the truth. The verdict saw it." in tab.text, "the failure")
    tab.press("Cure: Ask the other robots")
    settle(lambda: "r3's sighting of r4 would put it 3.7 m off." in tab.text, "the cure")
    assert tab.number("sample") == "home_fleet_island, sighting 4 alone → all of its sightings"
    tab.press("Once more, uncured")
    settle(lambda: "r3 saw r4" in tab.page.locator(".mm-title").inner_text(), "the exhibit again")
    tab.press("Leave the museum")
    settle(lambda: "office_r2_r1" in tab.page.locator(".mm-title").inner_text(), "the maps of before")
    assert not tab.page.get_by_text("Back to the fleet").is_visible()


def test_the_poster_is_believed_by_the_detector_refused_by_the_laser_and_by_the_verdict(tab):
    tab.press("Instant")
    tab.press("Museum")
    tab.choose("Exhibit", "9. A poster of a robot")
    settle(lambda: "the detector:" in tab.text, "what the detector says")
    assert tab.page.locator("svg.mm-picture image").count()
    assert "no step in depth" not in tab.text
    tab.press("Merge")
    settle(lambda: "from the truth. The verdict saw it." in tab.text, "the failure")
    assert tab.mood == "refused"
    assert "no step in depth" in tab.text
    tab.press("Cure: Let the laser have a say")
    settle(lambda: "Cured: " in tab.text, "the cure")
    assert tab.mood == "accepted"
    assert tab.number("known") == "a sighting → nothing"
    tab.press("Leave the museum")
    settle(lambda: not tab.page.get_by_text("Leave the museum").is_visible(), "the end of the visit")


def test_a_picture_is_taken_in_the_hand_with_mouse_and_sliders_go_along(open_tab):
    tab = open_tab(size=(1280, 800), smooth=True)
    tab.press("Lesson")
    tab.choose("Step", "2. Lift the walls near the meeting")
    tab.page.get_by_role("button", name="Take the ring in the hand").click()
    words = tab.page.locator("svg.mm-picture text", has_text="a wall 5 m away counts")
    before = settle(lambda: words.count() and words.first.text_content(), "the ring")
    grip = tab.page.locator("svg.mm-picture [data-mm-grip]")
    grip.scroll_into_view_if_needed()
    box = grip.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    tab.page.mouse.move(x, y)
    tab.page.mouse.down()
    tab.page.mouse.move(x + 25, y, steps=4)
    settle(lambda: words.first.text_content() != before, "the picture to go along before the hand lets go")
    tab.page.mouse.up()
    # Between two pictures there is no handle, and so no box.
    settle(lambda: (grip.bounding_box() or box)["x"] == pytest.approx(box["x"] + 25, abs=4), "the handle")


def test_a_question_is_answered_by_hand_ticked_and_kept_over_a_reload(open_tab):
    tab = open_tab(smooth=True)
    enter(tab, 7)
    ask = tab.page.locator(".mm-check:visible")
    settle(lambda: "can't tell apart" in ask.inner_text(), "the question")
    settle(lambda: tab.mood == "idle", "the run to be over")
    tab.press("Check")
    settle(lambda: "Not yet." in ask.inner_text(), "that it was not done")
    first = picture(tab)
    tab.move("candidate", 1)
    settle(lambda: picture(tab) != first, "the next candidate")
    tab.press("Check")
    settle(lambda: "Done." in ask.inner_text(), "that it was done")
    count = tab.page.locator(".mm-lesson small")
    settle(lambda: count.inner_text() == f"1 of {len(STEPS)} done", "the count")
    tab.page.reload()
    at_step(tab, 7)
    settle(lambda: count.inner_text() == f"1 of {len(STEPS)} done", "the count after a reload")
    settle(lambda: "Done." in ask.inner_text(), "the tick after a reload")


def test_maps_that_do_not_show_a_step_say_so_and_the_sample_that_does_is_opened(open_tab):
    tab = open_tab(smooth=True)
    enter(tab)
    tab.choose("Step", "14. What do the whole maps say?")
    at_step(tab, 14)
    settle(lambda: tab.page.locator(".mm-missing:visible").count(), "what these maps do not show")
    tab.press("Open corridor_r3_r2")
    settle(lambda: "corridor_r3_r2" in tab.page.locator(".mm-title").inner_text(), "the sample")
    at_step(tab, 14)
    settle(lambda: not tab.page.locator(".mm-missing:visible").count(), "that it shows it")
