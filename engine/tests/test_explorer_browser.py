"""The explorer in a browser, opened from the file system, without a network: what a reader does."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cspace import find_region, find_slices, load_robot
from cspace.explorer.page import explore, explorer_page
from cspace.region import margins, violated
from engine_support.arms import ROBOTS, SPATIAL, three_joints
from engine_support.browser import broken_rules, drag, in_every_family, rules_in, settle, wait_until

WALLS = {
    "many walls": lambda: (load_robot("two-joint-arm-with-walls"), {}),
    "portal": lambda: (load_robot("pp-portal"), {}),
    "six joints": lambda: (load_robot("ur5"), {j: load_robot("ur5").home[j] for j in range(4)}),
}
SIDES = 95


def many_sides() -> str:
    """A robot file: a portal whose safe region has very many vertices."""
    joint = "origin = [0, 0, 0]\nlimits = [-2, 2]"
    turns = [math.tau * k / SIDES for k in range(SIDES)]
    walls = [
        f'[[boundary]]\nname = "w{k}"\ntype = "half-space"\npoint = "tip"\n'
        f"normal = [{math.cos(t):.12f}, 0, {math.sin(t):.12f}]\noffset = -1\n"
        for k, t in enumerate(turns)
    ]
    return f"""
schema = 1
name = "many sides"
length_unit = "m"
angle_unit = "deg"
home = {{ a = 0, b = 0 }}
tool = "tip"
[[joint]]
name = "a"
type = "prismatic"
parent = "0"
frame = "1"
axis = [1, 0, 0]
{joint}
[[joint]]
name = "b"
type = "prismatic"
parent = "1"
frame = "2"
axis = [0, 0, 1]
{joint}
[[point]]
name = "tip"
frame = "2"
at = [0, 0, 0]
{"".join(walls)}"""


WIDTHS = {"wide screen": 1280, "phone": 390}
THEMES = ["light", "dark"]

TOOL = "qboundEngine.toolAt(explorer.slice.map, explorer.pair())"
SIDE = "Math.sign(qboundEngine.determinant(explorer.slice.map, explorer.pair()))"
RECORD = """() => {
  window.seen = [];
  explorer.root.addEventListener("qbound-pose", () => {
    const [pair, last] = [explorer.pair(), seen.at(-1)];
    if (String(pair) !== String(last)) seen.push(pair);
  });
}"""
LISTEN = """() => {
  window.heard = new Set();
  const text = explorer.part("task-text");
  const note = () => heard.add(text.textContent);
  new MutationObserver(note).observe(text, { childList: true });
}"""


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Write an explorer for every robot once."""
    folder = tmp_path_factory.mktemp("explorers")
    written = {}
    for i, (name, make) in enumerate((ROBOTS | SPATIAL | WALLS).items()):
        robot, held = make()
        written[name] = folder / f"{i}.html"
        page = explorer_page(find_region(robot, held), [(5, 0, 1, 2, 3), (2, 3, 4, 5, 0)])
        written[name].write_text(page, encoding="utf-8")
    return written


@pytest.fixture
def open_explorer(open_quietly, files):
    """Open explorers by their robot's name."""

    def open_one(name="paper", fragment="", **options):
        options = {"viewport": {"width": 1280, "height": 900}} | options
        return open_quietly(files[name].as_uri() + fragment, **options)

    return open_one


def pose(page):
    return page.evaluate("explorer.state.q")


def degrees(page):
    return np.degrees(pose(page))


def centre(page, selector):
    box = page.locator(selector).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def on_screen(page, picture, values):
    """Return where values of a picture ("joints" or "plane") lie on the screen."""
    x, y = page.evaluate("([name, v]) => explorer[name].at(v)", [picture, values])
    box = page.locator(f"#{picture}").bounding_box()
    return box["x"] + x, box["y"] + y


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("width", WIDTHS)
def test_every_kind_of_robot_opens(open_explorer, name, width):
    page = open_explorer(name, viewport={"width": WIDTHS[width], "height": 850})
    assert any(word in page.inner_text("#status") for word in ("afe", "easible"))
    assert page.locator("#joints .arc").count() > 0
    assert page.locator("#plane .workspace").count() == 2
    for family in in_every_family(page):
        assert page.evaluate("document.documentElement.scrollWidth") <= WIDTHS[width], family
        assert covered(page, "#joints text") == [], family
        assert beyond(page) == [], family


def test_a_joint_that_does_not_move_the_tool_is_named(open_explorer):
    """It said that the tool leaves the plane."""
    page = open_explorer("six joints")
    said = "The tool is not moved by wrist_3_joint: move the arm in joint space."
    assert page.inner_text("#posture") == said


def test_many_balls_are_a_row_for_two_links_with_the_least_margin(open_explorer):
    """A UR5 had 193 rows."""
    page, robot = open_explorer("six joints"), load_robot("ur5")
    rows = [row.split("\t") for row in page.locator("#margins tr").all_inner_texts()]
    assert len(rows) < 20
    counts = {links: int(first.split()[0]) for first, links, _ in rows if "balls" in first}
    assert sum(counts.values()) == len(robot.boundaries)
    least = {}
    for name, margin in margins(robot, robot.home):
        links = " and ".join(ball.rpartition("/")[0] for ball in name.split(", "))
        least[links] = min(least.get(links, math.inf), margin)
    shown = {links: value for first, links, value in rows if "balls" in first}
    assert shown == {links: f"{least[links]:.4f} m" for links in counts}
    page.locator("#margins tr").first.hover()
    assert page.locator("#plane .ball.lit, #plane .lit").count() > 0


def test_a_tool_that_leaves_the_plane_is_moved_in_joint_space(open_explorer):
    page = open_explorer("out of the plane")
    assert "leaves the plane" in page.inner_text("#posture")
    assert "obliquely" in page.inner_text("#plane-title")
    shadow = page.locator("#plane .shadow").first.get_attribute("d")
    assert page.locator("#plane .wall[d^=M]").count() == 1  # the scale bar: no wall is a line here
    assert not page.locator("#plane .reach-me").is_visible()
    before = pose(page)
    page.click("#plane", position={"x": 60, "y": 60})
    assert pose(page) == before
    page.click("#joints", position={"x": 160, "y": 160})
    assert pose(page) != before
    assert page.locator("#plane .shadow").first.get_attribute("d") != shadow
    page.check("#show-sample")
    assert page.is_disabled("#flip")
    assert page.is_disabled("#show-workspace")  # the layer was ticked, and showed nothing
    assert not page.is_checked("#show-workspace")


def test_dragging_the_dot_moves_the_arm(open_explorer):
    page = open_explorer()
    tool = page.evaluate(TOOL)
    target = np.radians([-60, -90]).tolist()
    drag(page, centre(page, "#joints .handle"), on_screen(page, "joints", target))
    assert_allclose(degrees(page), [-60, -90], atol=1)
    assert page.evaluate(TOOL) != tool
    assert page.input_value("#value-0") == str(round(degrees(page)[0], 1))


def test_dragging_the_tool_keeps_the_posture_and_the_tool_under_the_hand(open_explorer):
    page = open_explorer()
    side = page.evaluate(SIDE)
    drag(page, centre(page, "#plane .handle"), on_screen(page, "plane", [10.0, 66.0]), 30)
    assert_allclose(page.evaluate(TOOL), [10, 66], atol=0.5)
    assert page.evaluate(SIDE) == side


def test_a_tool_dragged_out_of_reach_stretches_the_arm_and_says_so(open_explorer):
    page = open_explorer()
    drag(page, centre(page, "#plane .handle"), on_screen(page, "plane", [54.0, 75.0]), 30)
    assert_allclose(degrees(page)[1], -59.9993, atol=1e-3)
    assert "Singular" in page.inner_text("#posture")
    assert page.locator("#joints .singular.lit").count() > 0


@pytest.fixture
def phone(open_explorer):
    return open_explorer(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)


def test_a_touch_drags_the_dot(phone):
    x, y = centre(phone, "#joints .handle")
    client = phone.context.new_cdp_session(phone)

    def touch(kind, *points):
        places = [{"x": px, "y": py} for px, py in points]
        client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": places})

    touch("touchStart", (x, y))
    for i in range(1, 9):
        touch("touchMove", (x - 5 * i, y + 4 * i))
    touch("touchEnd")
    settle(phone)
    assert_allclose(centre(phone, "#joints .handle"), [x - 40, y + 32], atol=1.5)


def test_a_tap_brings_the_dot(phone):
    x, y = centre(phone, "#joints .handle")
    phone.touchscreen.tap(x - 60, y + 70)
    settle(phone)
    assert_allclose(centre(phone, "#joints .handle"), [x - 60, y + 70], atol=1.5)


def test_arrow_keys_move_joints_and_tool(open_explorer):
    page = open_explorer()
    page.focus("#joints")
    for key in ["ArrowRight", "ArrowRight", "Shift+ArrowDown", "ArrowUp"]:
        page.keyboard.press(key)
    assert_allclose(degrees(page), [2, -9], atol=1e-9)
    before = np.array(page.evaluate(TOOL))
    page.focus("#plane")
    page.keyboard.press("ArrowUp")
    step = np.array(page.evaluate(TOOL)) - before
    assert_allclose(step, [0, page.evaluate("explorer.robot.reach * 0.01")], atol=1e-9)
    page.keyboard.press("h")
    assert_allclose(pose(page), 0, atol=1e-12)


def test_typing_a_value_moves_the_arm_and_the_screen_reader_hears_it(open_explorer):
    page = open_explorer()
    page.fill("#value-0", "80")
    assert_allclose(degrees(page), [80, 0], atol=1e-9)
    assert "Not feasible by points" in page.inner_text("#status")
    wait_until(page, "document.getElementById('live').textContent.includes('q1 80.0°')")
    assert "oint 3 (the tool) is" in page.inner_text("#live")
    assert "beyond B7" in page.inner_text("#live")


def test_the_violated_boundary_is_lit_in_table_and_pictures(open_explorer):
    page = open_explorer()
    page.fill("#value-0", "80")
    assert page.locator("#margins tr.lit th").all_inner_texts() == ["B7"]
    ((_, margin),) = violated(load_robot("minervabot-v2"), np.radians([80, 0]))
    assert page.locator("#margins tr.lit td").last.inner_text() == f"−{-margin:.2f} cm"
    assert page.locator("#plane .wall.lit").count() == 1
    assert page.locator("#joints path.arc.lit").count() >= 2
    page.fill("#value-0", "0")
    assert page.locator(".lit:not(.readout)").count() == 0


def test_switching_the_posture_passes_the_singular_curve_and_keeps_the_place(open_explorer):
    page = open_explorer()
    place = page.evaluate(TOOL)
    page.evaluate(RECORD)
    page.click("#flip")
    wait_until(page, "!explorer.isPlaying() && Math.abs(explorer.state.q[1]) > 1")
    line = math.radians(-59.9993)
    seen = np.array(page.evaluate("window.seen"))[:, 1]
    assert seen.min() < line < seen.max()
    assert_allclose(page.evaluate(TOOL), place, atol=1e-6)
    assert "Posture A" in page.inner_text("#posture")


def test_the_mirrored_pose_is_across_the_singular_curve_and_the_page_says_why(open_explorer):
    page = open_explorer()
    assert "mirror image" in page.inner_text("#task-text")
    page.evaluate(LISTEN)
    # A frame moves the arm 100 ms on at most; at half speed that is less than the line is thick.
    page.select_option("#speed", "0.5")
    page.click("#task-go")
    wait_until(page, "explorer.part('task-text').textContent.startsWith('There.')")
    wait_until(page, "!explorer.isPlaying()")
    assert_allclose(degrees(page), [-60, -120], atol=2e-3)
    words = page.evaluate("[...window.heard]")
    assert any(text.startswith("Now both links lie in one line") for text in words)


def test_the_largest_safe_scale_divides_safe_from_unsafe(open_explorer):
    page = open_explorer()
    page.click("#largest")
    assert "All of it is feasible by points" in page.inner_text("#clearance")
    assert page.locator("#joints .polygon.unsafe").count() == 0
    page.focus("#scale")
    for _ in range(4):
        page.keyboard.press("ArrowRight")
    assert "Not all of it is feasible by points" in page.inner_text("#clearance")
    assert page.locator("#joints .polygon.unsafe").count() == 1


def test_a_traversal_plays_pauses_and_goes_on(open_explorer):
    page = open_explorer()
    page.select_option("#walk", "1")
    page.select_option("#speed", "2")
    start = pose(page)
    page.click("#play")
    wait_until(page, "explorer.state.progress > 0.05", then="explorer.part('play').click()")
    here = pose(page)
    settle(page)
    assert pose(page) == here != start
    assert page.inner_text("#play") == "Play"
    page.click("#play")
    wait_until(page, "!explorer.isPlaying() && explorer.state.progress === 1")
    corners = page.evaluate("explorer.walkStops()")
    assert_allclose(pose(page), corners[-1], atol=1e-9)
    assert "Feasible by points" in page.inner_text("#status")


def test_reduced_motion_jumps_from_vertex_to_vertex(open_explorer):
    page = open_explorer(reduced_motion="reduce")
    page.evaluate(RECORD)
    page.select_option("#speed", "2")
    page.click("#play")
    wait_until(page, "!explorer.isPlaying() && explorer.state.progress === 1")
    corners = page.evaluate("explorer.walkStops()")
    assert_allclose(page.evaluate("window.seen"), corners[1:], atol=1e-9)


def test_random_poses_are_shown_and_hidden(open_explorer):
    page = open_explorer()
    assert page.locator("#joints .sample").count() == 0
    page.check("#show-sample")
    marks = page.locator("#joints .sample .dots, #plane .sample .dots")
    assert marks.count() == 4
    drawn = page.evaluate("explorer.state.sample.filter((one) => one.safe && one.home).length")
    assert marks.first.get_attribute("d").count("M") == drawn > 100
    page.uncheck("#show-sample")
    assert page.locator("#joints .sample").count() == 0


def test_a_link_restores_the_view(open_explorer):
    page = open_explorer()
    page.fill("#value-0", "-40")
    page.fill("#value-1", "-30.5")
    page.check("#show-names")
    page.uncheck("#show-workspace")
    page.evaluate("explorer.setScale(0.8)")
    wait_until(page, "location.hash.includes('scale=0.8&')")
    link = page.input_value("#link")
    assert link == page.url
    again = open_explorer(fragment=link[link.index("#") :])
    assert_allclose(degrees(again), [-40, -30.5], atol=1e-3)
    assert again.is_checked("#show-names")
    assert not again.is_checked("#show-workspace")
    assert again.evaluate("explorer.state.scale") == 0.8


@pytest.mark.parametrize(
    "fragment",
    ["#q=NaN,1", "#q=1", "#q=1e999,0&scale=-3", "#scale=9&walk=77&at=x", "#q=%3Cb%3E,0&show=;"],
)
def test_a_broken_link_opens_the_home_pose(open_explorer, fragment):
    page = open_explorer(fragment=fragment)
    assert pose(page) == [0, 0]
    assert 0 < page.evaluate("explorer.state.scale") < 1
    assert page.evaluate("explorer.state.walk") == 0


def test_a_held_joints_slider_shows_another_slice(open_explorer):
    page = open_explorer("3R, third held")
    exact = page.evaluate("explorer.slice.exact")
    before = page.locator("#joints .home").get_attribute("d")
    page.fill("#value-2", "-100")
    assert (exact, page.evaluate("explorer.slice.exact")) == (True, False)
    assert page.locator("#joints .home").get_attribute("d") != before
    assert page.locator("#joints .arc").count() > 0


def test_the_slider_of_a_row_goes_from_exact_slice_to_exact_slice(open_quietly, tmp_path):
    robot = three_joints()
    row = find_slices(robot, "q3", [-1.2, -0.2, 0.8])
    explore(row.regions[1], row).save(tmp_path / "row.html")
    page = open_quietly((tmp_path / "row.html").as_uri())
    slide, note = page.locator("#slide-2"), page.locator("#row")
    before = page.locator("#joints .home").get_attribute("d")
    assert note.inner_text().startswith(f"Slice 2 of 3: feasible area {row.areas[1]:.5g} rad²")
    slide.press("ArrowRight")
    assert pose(page)[2] == 0.8
    assert page.evaluate("[explorer.slice.exact, explorer.slice.own]") == [True, False]
    assert page.locator("#joints .home").get_attribute("d") != before
    assert note.inner_text().startswith(f"Slice 3 of 3: feasible area {row.areas[2]:.5g} rad²")
    page.fill("#value-2", "-50")  # the nearest slice
    assert pose(page)[2] == -1.2


def test_a_new_size_is_laid_out_again(open_explorer):
    page = open_explorer()
    wide = page.locator("#joints").bounding_box()
    assert page.locator("#plane").bounding_box()["y"] == pytest.approx(wide["y"], abs=1)
    page.set_viewport_size({"width": 390, "height": 844})
    settle(page)
    narrow = page.locator("#joints").bounding_box()
    assert page.locator("#plane").bounding_box()["y"] > narrow["y"] + narrow["height"]
    assert page.locator("#joints").get_attribute("viewBox") == (
        f"0 0 {narrow['width']:.0f} {narrow['height']:.0f}"
    )
    assert page.evaluate("document.documentElement.scrollWidth <= 390")


def test_it_prints_both_pictures_and_the_margins_on_one_page(open_explorer):
    page = open_explorer()
    page.emulate_media(media="print")
    settle(page)
    for shown in ("#joints", "#plane", "#margins", "#status"):
        assert page.locator(shown).is_visible()
    for hidden in ("#play", "#scaling", "#task", "#home"):
        assert not page.locator(hidden).is_visible()
    pdf = page.pdf(format="A4")
    assert pdf.count(b"/Type /Page\n") == 1


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("name", ["paper", "PP", "3R, second held"])
def test_the_accessibility_rules_find_nothing(open_explorer, name, width):
    page = open_explorer(name, viewport={"width": WIDTHS[width], "height": 850})
    page.fill("#value-0", "80")
    for theme in THEMES:
        page.emulate_media(color_scheme=theme)
        settle(page)
        assert broken_rules(page, **rules_in(theme)) == [], theme


@pytest.mark.parametrize("width", WIDTHS)
def test_everything_to_press_has_room_for_a_finger(open_explorer, width):
    page = open_explorer(viewport={"width": WIDTHS[width], "height": 850})
    small = page.evaluate(
        """() => [...document.querySelectorAll("button, select, input, .check")]
            .filter((e) => e.type !== "checkbox")
            .filter((e) => e.offsetParent && e.offsetHeight < 40).map((e) => e.outerHTML)"""
    )
    assert small == []
    assert page.evaluate("document.querySelector('.reach-me').getBBox().width") >= 40


@pytest.mark.parametrize("theme", THEMES)
def test_words_in_the_pictures_stand_out_from_their_ground(open_explorer, theme):
    page = open_explorer(color_scheme=theme)
    ratios = page.evaluate(
        """() => {
          const light = (c) => { const [r, g, b] = c.match(/\\d+/g).map((v) => { v /= 255;
            return v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; });
            return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
          return [...document.querySelectorAll("svg text")].map((t) => {
            const ground = light(getComputedStyle(t.closest("svg")).backgroundColor);
            const ink = light(getComputedStyle(t).fill);
            return (Math.max(ground, ink) + 0.05) / (Math.min(ground, ink) + 0.05); }); }"""
    )
    assert len(ratios) > 20
    assert min(ratios) >= 4.5


@pytest.mark.parametrize("name", ["paper", *WALLS])
@pytest.mark.parametrize("width", WIDTHS)
def test_names_of_arcs_vertices_and_walls_do_not_cover_each_other(open_explorer, width, name):
    page = open_explorer(name, viewport={"width": WIDTHS[width], "height": 850})
    for family in in_every_family(page):
        assert covered(page, "#joints text") == [], family
        assert covered(page, "#plane .walls text") == [], family
        assert beyond(page) == [], family


def test_numbers_of_many_vertices_do_not_cover_each_other(open_quietly, tmp_path):
    (tmp_path / "many.toml").write_text(many_sides(), encoding="utf-8")
    region = find_region(load_robot(tmp_path / "many.toml"))
    assert len(region.home_component.vertices) == SIDES
    explore(region).save(tmp_path / "many.html")
    page = open_quietly((tmp_path / "many.html").as_uri())
    assert page.locator("#joints .vertex-name").count() > 10
    assert covered(page, "#joints .vertex-name") == []


def covered(page, picture):
    boxes = page.evaluate(
        """(picture) => [...document.querySelectorAll(picture)].map((t) => {
            const { x, y, width, height } = t.getBoundingClientRect(); // some are turned
            return [t.textContent, x, y + 2, x + width, y + height - 2]; })""",
        picture,
    )
    return [
        (a[0], b[0])
        for i, a in enumerate(boxes)
        for b in boxes[i + 1 :]
        if min(a[3], b[3]) > max(a[1], b[1]) and min(a[4], b[4]) > max(a[2], b[2])
    ]


def beyond(page):
    """Return the words that leave their picture."""
    return page.evaluate(
        """() => [...document.querySelectorAll("#joints text, #plane text:not([hidden])")]
            .filter((t) => {
              const [word, box] = [t, t.closest("svg")].map((e) => e.getBoundingClientRect());
              return word.left < box.left - 1 || word.right > box.right + 1
                || word.top < box.top - 1 || word.bottom > box.bottom + 1; })
            .map((t) => t.textContent)"""
    )


def test_the_letters_of_all_three_families_are_drawn(open_explorer):
    page = open_explorer()
    width = "document.querySelector('#joints .line-name').getBBox().width"
    narrow, usual, wide = (page.evaluate(width) for _ in in_every_family(page))
    assert narrow < usual < wide


def test_without_scripts_the_page_says_what_it_would_show(tabs, files):
    with tabs.lent(java_script_enabled=False) as tab:
        tab.page.goto(files["paper"].as_uri())
        words = tab.page.inner_text("noscript")
    assert "needs JavaScript" in words
    assert "5 pieces" in words


def test_a_notebook_that_is_not_trusted_shows_the_picture(open_explorer, files, tmp_path):
    output = explore(find_region(load_robot("pp-portal")))._repr_html_()
    left = re.sub(r"<iframe.*</iframe>", "", output, flags=re.DOTALL)  # what a sanitizer leaves
    files["untrusted"] = tmp_path / "untrusted.html"
    files["untrusted"].write_text(f"<!doctype html>{left}", encoding="utf-8")
    page = open_explorer("untrusted")
    assert page.locator("iframe").count() == 0
    assert page.evaluate("document.querySelector('img').naturalWidth") > 200


def test_the_closest_boundary_is_named_and_shown(open_explorer):
    page = open_explorer()
    assert page.inner_text("#status") == (
        "Feasible by points. Closest: points 10 and 11 (B3) are 7.83 cm farther apart than they"
        " must be."
    )
    assert page.locator("#plane .point-name:not([hidden])").all_text_contents() == ["10", "11"]
    assert page.locator("#plane .gap.closest:not([hidden])").count() == 1
    page.fill("#value-0", "40")
    assert "point 3 (the tool) is" in page.inner_text("#status")
    gap = page.locator("#plane .gap.closest:not([hidden])")
    ends = [float(gap.get_attribute(name)) for name in ("x1", "x2", "y1", "y2")]
    assert ends[0] == pytest.approx(ends[1])  # straight down to the wall
    assert ends[2] < ends[3]


def test_the_ground_is_drawn_and_nothing_is_tinted_as_behind_a_wall(open_explorer):
    page = open_explorer()
    ground, base = (
        page.locator(part).first.evaluate(
            "(e) => { const b = e.getBBox(); return [b.y, b.height]; }"
        )
        for part in ("#plane .ground", "#plane .body.fixed")
    )
    assert ground[0] == pytest.approx(sum(base), abs=0.5)
    styles = page.locator("#plane .beyond").evaluate_all(
        "(all) => all.map((e) => getComputedStyle(e).fill)"
    )
    assert styles == ["none"]


def test_the_task_looks_at_the_side_where_the_arm_is_now(open_explorer):
    page = open_explorer()
    page.fill("#value-1", "-100")
    assert "other side" in page.inner_text("#task-text")
    page.fill("#value-1", "0")
    assert "Bring the arm" in page.inner_text("#task-text")  # back again: nothing is remembered
    page.fill("#value-0", "85")
    assert "not feasible by points" in page.inner_text("#task-text")


def test_random_poses_in_regions_that_are_cut_off_are_grey(open_explorer):
    page = open_explorer()
    page.check("#show-sample")
    counts = page.locator("#joints .sample path").evaluate_all(
        "(all) => all.map((e) => [e.getAttribute('class'), e.getAttribute('d').match(/M/g).length])"
    )
    assert dict(counts).keys() == {"dots", "dots away", "crosses"}
    assert all(count > 20 for _, count in counts)
    colours = page.locator("#joints .sample .dots").evaluate_all(
        "(all) => all.map((e) => getComputedStyle(e).stroke)"
    )
    assert len(set(colours)) == 2


@pytest.mark.parametrize("width", WIDTHS)
def test_axes_of_two_turns_are_labelled_apart(open_explorer, files, tmp_path, width):
    robot = load_robot("minervabot-v2")
    joints = tuple(replace(joint, limits=(-math.tau, math.tau)) for joint in robot.joints)
    files["turns"] = tmp_path / "turns.html"
    page = explorer_page(find_region(replace(robot, joints=joints)))
    files["turns"].write_text(page, encoding="utf-8")
    page = open_explorer("turns", viewport={"width": WIDTHS[width], "height": 850})
    assert "−360" in page.locator("#joints .axes").text_content()
    for family in in_every_family(page):
        assert covered(page, "#joints .axes text") == [], family
        assert beyond(page) == [], family


def test_a_phone_reads_no_words_of_a_mouse_or_a_keyboard(phone):
    words = phone.inner_text("body").lower()
    assert re.findall(r"\b(left|right|arrow keys?)\b", words) == []


def test_in_a_notebook_all_controls_work_and_no_link_is_offered(open_explorer, files, tmp_path):
    robot = load_robot("minervabot-v2")
    files["notebook"] = tmp_path / "notebook.html"
    output = explore(find_region(robot))._repr_html_()
    files["notebook"].write_text(f"<!doctype html>{output}", encoding="utf-8")
    whole = open_explorer("notebook")
    wait_until(whole, "document.querySelector('img') === null")  # the frame has come in its place
    page = whole.frame_locator("iframe")
    page.locator("#value-0").fill("80")
    assert "Not feasible by points" in page.locator("#status").inner_text()
    page.locator("#play").click()
    assert page.locator("#play").inner_text() == "Pause"
    assert not page.locator("#share").is_visible()
    assert not page.locator("#full-page").is_visible()
