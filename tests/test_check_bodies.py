# ruff: noqa: E501  (tables of faults, one a line)
"""Certificates of bodies: what both checkers accept, and faults and tricks that they refuse."""

import dataclasses
import hashlib
import itertools
import json
import random
import resource
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from jsonschema import validate

from qbound import check
from qbound.boundary.evaluator import evaluator
from qbound.model.robotfile import load_robot, parse_robot, robot_text
from qbound.proofs import certify as proving
from qbound.proofs import check_arb, features, parts, separating, statements
from support import arms_in_planes, brute_force

pytest.importorskip("flint")
CHECK, FILE = check.check, Path(check.__file__)

JOINT = """[[joint]]
name = "{name}"
type = "{type}"
parent = "{parent}"
frame = "{frame}"
origin = {origin}
axis = {axis}
limits = {limits}
"""

BODIES = """
[[point]]
name = "tip"
frame = "2"
at = [0.4, 0, 0]

[[body]]
name = "upper arm"
frame = "1"
capsule = { from = [0, 0], to = [0.5, 0], radius = 0.04 }

[[body]]
name = "hand"
frame = "2"
polygon = [[0.4, 0.03], [0.4, -0.03], [-0.05, -0.03], [-0.05, 0.03]]

[[obstacle]]
name = "crate"
polygon = [[0.6, 0.4], [0.9, 0.4], [0.9, 0.7], [0.6, 0.7]]

[[obstacle]]
name = "pillar"
disc = { at = [-0.3, 0.5, 0], radius = 0.1 }

[[obstacle]]
name = "hook"
polygon = [[0.2, -0.9], [0.8, -0.9], [0.8, -0.4], [0.7, -0.4], [0.7, -0.8], [0.45, -0.8], [0.2, -0.8]]

[[boundary]]
name = "floor"
type = "half-space"
body = "hand"
normal = [0, 1, 0]
offset = -0.75
"""


def arm(kinds="RR"):
    """Two links in the plane of x and y, amid a crate, a pillar and a hook."""
    lines = [
        'schema = 1\nname = "arm"\nlength_unit = "m"\nangle_unit = "deg"\ntool = "tip"',
        'home = { q1 = 0, q2 = 0 }\ncollisions = "all"\nclearance = 0.01',
        'allowed = [["upper arm", "hand"]]',
    ]
    for j, kind in enumerate(kinds):
        turns = kind == "R"
        lines.append(
            JOINT.format(
                name=f"q{j + 1}",
                type="revolute" if turns else "prismatic",
                parent=j,
                frame=j + 1,
                origin=[0.5 * j, 0, 0],
                axis=[0, 0, 1] if turns else [int(j == 0), int(j == 1), 0],
                limits=[-170, 170] if turns else [-1, 1],
            )
        )
    return "\n".join(lines) + BODIES


def box(low, high, margin="0"):
    return statements.box([str(x) for x in low], [str(x) for x in high], margin)


def path(*points):
    return statements.path([[str(x) for x in q] for q in points])


def square(low, high, margin="0"):
    (a, b), (c, d) = low, high
    corners = [[a, b], [c, b], [c, d], [a, d]]
    return statements.filled([[[str(x) for x in q] for q in corners]], margin)


def verdict_of(checker, text):
    try:
        return str(checker(text))
    except ValueError:
        return ""


def ours(text):
    return ("proved", "refuted")[CHECK(text).refuted]


def agreed(content):
    """Return what both checkers say; nothing where both refuse."""
    text = content if isinstance(content, str) else json.dumps(content)
    found = [verdict_of(checker, text) for checker in (ours, check_arb.verify)]
    assert found[0] == found[1]
    return found[0]


SMALL = {
    "RR": ((-15, -15), (15, 15)),
    "RP": ((-10, -0.2), (10, 0.2)),
    "PR": ((-0.1, -40), (0.2, 30)),
    "PP": ((-0.2, -0.3), (0.1, 0.2)),
}
"""Free of all obstacles, in degrees and lengths."""

WIDE = {
    "RR": ((20, -20), (60, 15)),
    "RP": ((-20, -0.4), (30, 0.6)),
    "PR": ((-0.1, -40), (0.4, 90)),
    "PP": ((-0.2, -0.3), (0.1, 0.6)),
}
"""The hand meets something."""


# --- what is proved, and what is refuted ----------------------------------------------------------


@pytest.mark.parametrize("kind", [box, square])
@pytest.mark.parametrize("kinds", SMALL)
def test_arms_of_all_kinds_are_proved_and_refuted(kinds, kind):
    schema = json.loads((FILE.parent / "schemas/certificate.schema.json").read_text())
    for region, verdict in ((SMALL, "proved"), (WIDE, "refuted")):
        answer = proving.certify(arm(kinds), kind(*region[kinds]))
        assert agreed(answer.text) == answer.verdict == verdict
        assert brute_force.tells_the_truth(answer.text)
        validate(json.loads(answer.text), schema)


@pytest.mark.parametrize(("scale", "verdict"), [(0.96, "proved"), (1, "refuted")])
def test_the_whole_bodies_of_the_papers_robot_are_proved_on_its_scaled_polygon(scale, verdict):
    text, _ = robot_text("minervabot-v2-bodies")
    answer = proving.certify(text, statements.home_polygon(parse_robot(tomllib.loads(text)), scale))
    assert agreed(answer.text) == answer.verdict == verdict
    assert brute_force.tells_the_truth(answer.text)


def test_no_chord_of_an_inner_polygon_leaves_the_region_of_bodies():
    """Arcs of features bend into the region; chords are halved until they stay beside it."""
    robot = load_robot("two-links-on-a-table")
    margins, steps = evaluator(robot).margins, np.linspace(0, 1, 30)[:, None, None]
    for loop in statements.inner_polygon(robot, 0.01)["points"]:
        q = np.radians(np.array(loop, dtype=float))
        chords = (1 - steps) * q + steps * np.roll(q, -1, axis=0)
        assert margins(chords).min() > 0


KINDS = ("RR", "RP", "PR", "PP")


@pytest.mark.parametrize("seed", range(12))
def test_certificates_of_random_scenes_are_true(seed):
    """All kinds of joints and planes; capsules, discs, boxes and hooks, either way round."""
    rng, kinds = random.Random(seed), KINDS[seed % 4]
    text = arms_in_planes.scene(seed, kinds, "zyx"[seed % 3])
    low = [rng.randint(-150, 120) if k == "R" else rng.randint(-9, 5) / 10 for k in kinds]
    sizes = [rng.randint(2, 30) if k == "R" else rng.randint(1, 4) / 10 for k in kinds]
    high = [round(x + size, 1) for x, size in zip(low, sizes, strict=True)]
    statement = (box, path, square)[seed // 4](low, high)
    answer = proving.certify(text, statement)
    assert agreed(answer.text) == answer.verdict != ""
    assert brute_force.tells_the_truth(answer.text, seed)


def test_another_feature_may_hold_on_the_next_leaf():
    """Beside the crate first an edge separates the hand, then a pair of corners."""
    data = json.loads(proving.certify(arm(), square((60, -20), (90, 20))).text)
    named = {leaf for tree in data["proof"]["hand, crate"] for leaf in tree.strip("abc").split(".")}
    assert len(named) > 2


def test_the_margin_is_kept_beside_the_clearance():
    statement = path((20, 0), (20, 1))
    assert proving.certify(arm(), statement).verdict == "proved"
    answer = proving.certify(arm(), statement | {"margin": "0.1"})
    assert answer.verdict == agreed(answer.text) == "refuted"


def test_what_has_no_inside_needs_no_distance():
    """Two discs of radius 0 that keep a distance of 0 need no proof; two segments need one."""
    text = arm().replace("clearance = 0.01", "clearance = 0")
    lone = "disc = { at = [-0.3, 0.5, 0], radius = 0 }"
    text = text.replace("disc = { at = [-0.3, 0.5, 0], radius = 0.1 }", lone)
    text = text.replace("radius = 0.04", "radius = 0")
    data = json.loads(proving.certify(text, box(*SMALL["RR"])).text)
    assert "upper arm, pillar" not in data["proof"]
    assert "hand, pillar" in data["proof"]
    two = text.replace(lone, "capsule = { from = [0.2, -0.1], to = [0.3, 0.1], radius = 0 }")
    crossing = proving.certify(two, path((0, 0), (0, 0))).text
    assert agreed(crossing) == "refuted"
    data = json.loads(crossing)
    data["robot"] = two.replace("to = [0.3, 0.1]", "to = [0.3, -0.05]")
    data["sha256"] = check.digest(data["robot"])
    assert agreed(data) == ""  # they come close, and do not cross
    clear = proving.certify(two, path((90, 0), (90, 0)))
    assert agreed(clear.text) == "proved"
    assert "upper arm, pillar" in json.loads(clear.text)["proof"]


def test_a_frame_that_is_mounted_askew_sees_its_bodies_as_the_library_does():
    """A mount turns the second frame's axes; the plane's numbers are those of its own axes."""
    text = arm().replace("origin = [0.5, 0, 0]", "origin = [0.5, 0, 0]\nrpy = [90, 0, 30]", 1)
    text = text.replace("axis = [0, 0, 1]\nlimits", "axis = [0, 1, 0]\nlimits")
    text = text.replace("axis = [0, 1, 0]", "axis = [0, 0, 1]", 1)
    for region in (((-20, -20), (0, 15)), ((20, 0), (50, 25))):
        answer = proving.certify(text, box(*region))
        assert agreed(answer.text) == answer.verdict != "undecided"
        assert brute_force.tells_the_truth(answer.text)


def test_what_is_not_in_a_plane_is_refused_by_both_checkers():
    data = small()
    text = data["robot"].replace("axis = [0, 0, 1]", "axis = [0, 0.1, 1]", 1)
    assert agreed(with_robot(data, text)) == ""
    slanted = data["robot"].replace("origin = [0.5, 0, 0]", "origin = [0.5, 0, 0]\nrpy = [0, 9, 0]")
    assert agreed(with_robot(data, slanted)) == ""


def test_robots_without_pairs_of_bodies_keep_their_grammar():
    text = arm().replace('collisions = "all"\n', "")
    answer = proving.certify(text, box(*SMALL["RR"]))
    data = json.loads(answer.text)
    assert data["schema"] == "qbound/certificate/2"
    assert {*data["proof"]} == {"floor"}
    assert agreed(data) == "proved"
    assert agreed(small() | {"schema": "qbound/certificate/2"}) == ""


# --- a faulty prover ------------------------------------------------------------------------------


def claimed(monkeypatch, text, statement):
    """Return what a prover would write if nobody looked at it."""
    files = []

    def credulous(file):
        files.append(file)
        return check.Answer(False, "")

    monkeypatch.setattr(check, "check", credulous)
    answer = proving.certify(text, statement)
    return files[-1] if answer.verdict == "proved" else ""


def replaced_features(monkeypatch, change):
    """Change the groups of forms of the features of two cores."""
    true = features.features_of

    def faulty(*arguments):
        found = true(*arguments)
        return dataclasses.replace(found, groups=tuple(change(found)))

    monkeypatch.setattr(features, "features_of", faulty)


def no_clearance(monkeypatch):
    monkeypatch.setattr(features, "asked_distance", lambda robot, pair: sum(
        robot.body(name).parts[0].radius for name in pair.bodies))  # fmt: skip


def no_radii(monkeypatch):
    monkeypatch.setattr(features, "asked_distance", lambda robot, pair: pair.clearance)


def no_margin(monkeypatch):
    monkeypatch.setattr(proving, "wider", lambda robot, statement: robot)


def normals_inwards(monkeypatch):
    true = features.Core.normals.fget
    monkeypatch.setattr(features.Core, "normals", property(lambda core: [-n for n in true(core)]))


def normals_of_no_sense(monkeypatch):
    def normals(core):
        ends = zip(core.corners, [*core.corners[1:], core.corners[0]], strict=True)
        return [-1j * (b - a) / abs(b - a) for a, b in ends if a != b]

    monkeypatch.setattr(features.Core, "normals", property(normals))


def edges_only(keep):
    def fault(monkeypatch):
        replaced_features(monkeypatch, lambda found: [
            keep(group) if k < found.edges else group for k, group in enumerate(found.groups)
        ])  # fmt: skip

    return fault


def pairs_only(keep):
    def fault(monkeypatch):
        replaced_features(monkeypatch, lambda found: [
            group if k < found.edges else keep(group) for k, group in enumerate(found.groups)
        ])  # fmt: skip

    return fault


def turns_backwards(monkeypatch):
    true = features._with
    monkeypatch.setattr(features, "_with", lambda key, j, k: true(key, j, -k if j == 1 else k))


def no_origin(monkeypatch):
    true = features.FlatArm.__init__

    def start(flat, robot):
        true(flat, robot)
        flat.origins = [0.8 * origin for origin in flat.origins]

    monkeypatch.setattr(features.FlatArm, "__init__", start)


def slides_backwards(monkeypatch):
    true = features.FlatArm.__init__

    def start(flat, robot):
        true(flat, robot)
        flat.slides = [-slide for slide in flat.slides]

    monkeypatch.setattr(features.FlatArm, "__init__", start)


def centres_are_enough(monkeypatch):
    monkeypatch.setattr(separating, "second_order", lambda form, cells: form(cells.mean(axis=1)))


def corners_are_enough(monkeypatch):
    monkeypatch.setattr(separating, "second_order", lambda form, cells: form(cells).min(axis=1))


def nothing_bends(monkeypatch):
    def bound(form, cells):
        centre = cells.mean(axis=1)
        rise = np.einsum("nkj,nmj->nkm", cells - centre[:, None], form.gradient(centre))
        return form(centre) + rise.min(axis=1)

    monkeypatch.setattr(separating, "second_order", bound)


def every_other_cell(monkeypatch):
    true = separating._bounded

    def bounded(found, cells):
        number, form = true(found, cells)
        number[1::2] = np.maximum(number[1::2], 0)
        return number, form

    monkeypatch.setattr(separating, "_bounded", bounded)


def overlooked(monkeypatch):
    """See no violation, and take the best feature as proved."""
    true = separating._bounded

    def bounded(found, cells):
        _, form = true(found, cells)
        return found.lengths(cells.centres).argmax(axis=1), form

    monkeypatch.setattr(separating, "_bounded", bounded)
    monkeypatch.setattr(features.Features, "margins", lambda self, q: np.ones(len(q)))


def renumbered(change):
    def fault(monkeypatch):
        monkeypatch.setattr(separating, "_leaf", lambda found, k: (
            f"{change(found, int(k))}." if found.numbered else "."))  # fmt: skip

    return fault


def no_distance_of_corners(monkeypatch):
    """Ask pairs of corners to be apart at all."""
    true = features.features_of

    def faulty(*arguments):
        found = true(*arguments)
        forms, squares = found.forms.coefficients.copy(), ~np.isnan(found.squared)
        forms[squares, 0, 0] += found.gap**2
        lengths = np.where(squares, 0.0, np.nan)
        forms = features.HarmonicForm(forms, found.forms.kinds)
        return dataclasses.replace(found, forms=forms, squared=lengths)

    monkeypatch.setattr(features, "features_of", faulty)


def first_parts_only(monkeypatch):
    true = proving.all_features
    monkeypatch.setattr(proving, "all_features", lambda *arguments: true(*arguments)[:1])


def first_parts_for_all(monkeypatch):
    true = proving.all_features

    def found(*arguments):
        every = true(*arguments)
        return [every[0]] * len(every)

    monkeypatch.setattr(proving, "all_features", found)


def parts_by(change):
    def fault(monkeypatch):
        true = parts.cut
        monkeypatch.setattr(parts, "cut", lambda corners: change(corners, true(corners)))

    return fault


def no_last_boundary(monkeypatch):
    true = proving._between_bodies
    monkeypatch.setattr(proving, "_between_bodies", lambda *arguments: true(*arguments)[:-1])


def all_allowed(monkeypatch):
    true = proving._between_bodies
    monkeypatch.setattr(proving, "_between_bodies", lambda *arguments: [
        (robot, b) for robot, b in true(*arguments) if "crate" not in b.name])  # fmt: skip


def other_limits(monkeypatch):
    monkeypatch.setattr(proving, "beyond_limits", lambda *_: None)


CLIPPING = path((20, 0), (30, 0))
"""The hand comes into the crate."""

GRAZING = path((15, 0), (24, 0))
"""At the end the hand is nearer to the crate than the clearance, by 3 mm."""

HOOKED = path((-45, 20), (-30, 0))
"""The hand comes into the hook's upright, not into its foot."""

FAULTS = {
    "the clearance is forgotten": (no_clearance, GRAZING),
    "the radii are forgotten": (no_radii, path((100, 0), (112, 0))),
    "the margin is forgotten": (no_margin, path((20, 0), (20, 1)) | {"margin": "0.1"}),
    "normals point inwards": (normals_inwards, path((20, 0), (40, 0))),
    "normals are those of an outline anticlockwise": (normals_of_no_sense, path((20, 0), (40, 0))),
    "one corner stands for all": (edges_only(lambda group: group[:1]), CLIPPING),
    "the last corner is forgotten": (edges_only(lambda group: group[: max(1, len(group) - 1)]), square(*SMALL["RR"])),
    "corners need not be nearest": (pairs_only(lambda group: group[:1]), GRAZING),
    "corners need be nearest on one side": (pairs_only(lambda group: group[:3]), GRAZING),
    "corners need be nearest on the other": (pairs_only(lambda group: group[[0, *range(3, len(group))]]), GRAZING),
    "corners need not keep the distance": (no_distance_of_corners, path((100, -90), (115, -90))),
    "a joint turns backwards": (turns_backwards, square((60, -20), (90, 20))),
    "the links are shorter": (no_origin, GRAZING),
    "a joint slides backwards": (slides_backwards, path((12, 0), (12, 0.38))),
    "a centre is enough": (centres_are_enough, GRAZING),
    "corners are enough": (corners_are_enough, square(*SMALL["RR"])),
    "nothing bends": (nothing_bends, square(*SMALL["RR"])),
    "every other cell is looked at": (every_other_cell, GRAZING),
    "no violation is seen": (overlooked, CLIPPING),
    "numbers are one too high": (renumbered(lambda _, k: k + 1), square(*SMALL["RR"])),
    "the bodies are exchanged": (renumbered(lambda found, k: (k + found.edges // 2) % found.edges if k < found.edges else k), square(*SMALL["RR"])),
    "pairs of corners are counted backwards": (renumbered(lambda found, k: k if k < found.edges else len(found.groups) - 1 - (k - found.edges)), square(*SMALL["RR"])),
    "the first pair of parts alone": (first_parts_only, path((60, 0), (100, 0))),
    "the first pair of parts for all": (first_parts_for_all, square(*SMALL["RR"])),
    "an outline is its hull": (parts_by(lambda corners, _: [[*range(len(corners))]]), square(*SMALL["RR"])),
    "a part is left out": (parts_by(lambda _, found: found[1:] or found), HOOKED),
    "the last pair is left out": (no_last_boundary, HOOKED),
    "the crate may be touched": (all_allowed, CLIPPING),
    "limits are overlooked": (other_limits, path((165, 165), (175, 165))),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_what_a_faulty_prover_claims_is_refused_by_both_checkers(monkeypatch, name):
    fault, statement = FAULTS[name]
    text = arm("RP" if "slides" in name else "RR")
    with monkeypatch.context() as patched:
        fault(patched)
        file = claimed(patched, text, statement)
    assert file, "the fault does not show"
    assert agreed(file) == ""


def test_there_are_twenty_faults_and_more():
    assert len(FAULTS) >= 20


# --- corrupted certificates -----------------------------------------------------------------------


@cache
def small_text():
    return proving.certify(arm(), square(*SMALL["RR"])).text


def small():
    return json.loads(small_text())


@cache
def refuted_text():
    return proving.certify(arm(), square(*WIDE["RR"])).text


def refuted():
    return json.loads(refuted_text())


def with_robot(data, text):
    return data | {"robot": text, "sha256": hashlib.sha256(text.encode()).hexdigest()}


def put(*place, value):
    def change(data):
        inner = data
        for step in place[:-1]:
            inner = inner[step]
        inner[place[-1]] = value(inner[place[-1]]) if callable(value) else value

    return change


def robot(old, new):
    def change(data):
        assert old in data["robot"]
        data |= with_robot(data, data["robot"].replace(old, new, 1))

    return change


def drop(*place):
    def change(data):
        inner = data
        for step in place[:-1]:
            inner = inner[step]
        del inner[place[-1]]

    return change


HAND, HOOK_PARTS = ("proof", "hand, crate"), ("parts", "hook")
CORRUPTED = {
    "a feature that does not separate": put(*HAND, 0, value="3."),
    "a feature that there is not": put(*HAND, 0, value="24."),
    "a feature with a huge number": put(*HAND, 0, value="999999999."),
    "a feature with a longer number": put(*HAND, 0, value="9999999999."),
    "a feature with a zero before it": put(*HAND, 0, value="01."),
    "a negative feature": put(*HAND, 0, value="-1."),
    "a leaf without a feature": put(*HAND, 0, value="."),
    "a number without a leaf": put(*HAND, 0, value=lambda tree: tree + "1"),
    "a feature of a half-space": put("proof", "floor", 0, value="0."),
    "a tree in capitals": put(*HAND, 0, value="A1.1."),
    "a tree for a pair left out": put(*HAND, value=lambda trees: trees[1:]),
    "trees of two pairs exchanged": put("proof", value=lambda proof: proof | {
        "hand, crate": proof["hand, pillar"], "hand, pillar": proof["hand, crate"]}),
    "a pair left out": drop("proof", "hand, hook"),
    "a pair of no boundary": put("proof", "hand, floor", value=["0.", "0."]),
    "pairs of parts left out": put("proof", "hand, hook", value=lambda trees: trees[:2]),
    "parts left out": drop("parts"),
    "parts of a body left out": drop("parts", "crate"),
    "parts of a disc": put("parts", "pillar", value=[[0]]),
    "parts of no body": put("parts", "nothing", value=[[0, 1, 2]]),
    "an outline of no parts": put(*HOOK_PARTS, value=[]),
    "a part left out of an outline": put(*HOOK_PARTS, value=lambda found: found[1:]),
    "a part twice": put(*HOOK_PARTS, value=lambda found: [*found, found[0]]),
    "a part inside out": put(*HOOK_PARTS, 0, value=lambda part: part[::-1]),
    "a part that is not convex": put(*HOOK_PARTS, value=[[*range(7)]]),
    "a flat part": put(*HOOK_PARTS, value=lambda found: [*found, [4, 5, 6]]),
    "parts that overlap": put(*HOOK_PARTS, 0, value=[0, 1, 2, 3]),
    "a part of a corner that is not there": put(*HOOK_PARTS, 0, 0, value=7),
    "a part with an index from the end": put(*HOOK_PARTS, 0, 0, value=-1),
    "a part of two corners": put(*HOOK_PARTS, 0, value=[0, 1]),
    "a part with a corner twice": put("parts", "crate", 0, value=[0, 1, 2, 3, 3]),
    "a part round twice": put("parts", "crate", 0, value=[0, 1, 2, 3, 0, 1, 2, 3]),
    "the older schema": put("schema", value="qbound/certificate/2"),
    "places beside a proof": put("places", value=[{"part": 0, "weights": ["1"]}] * 2),
    "a larger obstacle": robot("[[0.6, 0.4], [0.9, 0.4]", "[[0.6, 0.1], [0.9, 0.1]"),
    "a thicker arm": robot("radius = 0.04", "radius = 0.4"),
    "more clearance": robot("clearance = 0.01", "clearance = 0.3"),
    "an obstacle dropped": robot('[[obstacle]]\nname = "pillar"\ndisc = { at = [-0.3, 0.5, 0], radius = 0.1 }\n', ""),
    "collisions dropped": robot('collisions = "all"\n', ""),
    "collisions of another kind": robot('"all"', '"some"'),
    "all is allowed": robot('allowed = [["upper arm", "hand"]]', 'allowed = [["hand", "crate"], ["upper arm", "hand"]]'),
    "less is allowed": robot('allowed = [["upper arm", "hand"]]', ""),
    "what is not there is allowed": robot('["upper arm", "hand"]', '["upper arm", "thumb"]'),
    "one body is allowed": robot('["upper arm", "hand"]', '["hand", "hand"]'),
    "two shapes": robot("disc =", "polygon = [[0, 0], [1, 0], [0, 1]]\ndisc ="),
    "no shape": robot("disc = { at = [-0.3, 0.5, 0], radius = 0.1 }", ""),
    "a negative radius": robot("radius = 0.1", "radius = -0.1"),
    "a disc of no place": robot("at = [-0.3, 0.5, 0], radius", "radius"),
    "a huge number": robot("radius = 0.1", "radius = 1e101"),
    "a large number": robot("radius = 0.1", "radius = 1e99"),
    "corners of four numbers": robot("[0.6, 0.4]", "[0.6, 0.4, 0, 0]"),
    "an outline out of its plane": robot("[0.6, 0.4], [0.9, 0.4]", "[0.6, 0.4, 0.1], [0.9, 0.4]"),
    "an outline that is flat": robot("[0.9, 0.7], [0.6, 0.7]", "[0.8, 0.4], [0.7, 0.4]"),
    "an outline with an edge of no length": robot("[0.9, 0.7], [0.6, 0.7]", "[0.6, 0.7], [0.6, 0.7]"),
    "an outline that crosses itself": robot("[0.9, 0.7], [0.6, 0.7]", "[0.6, 0.7], [0.9, 0.7]"),
    "two bodies of a name": robot('name = "pillar"', 'name = "crate"'),
    "a body without a frame": robot('name = "hand"\nframe = "2"', 'name = "hand"'),
    "an obstacle in a frame": robot('name = "pillar"\n', 'name = "pillar"\nframe = "0"\n'),
    "a pair of one frame": robot('[[boundary]]', '[[boundary]]\nname = "x"\ntype = "bodies"\nbodies = ["crate", "pillar"]\n\n[[boundary]]'),
    "a boundary of the name of a pair": robot('name = "floor"', 'name = "hand, crate"'),
    "a half-space of two": robot('body = "hand"\n', 'body = "hand"\npoint = "tip"\n'),
    "a half-space of none": robot('body = "hand"\n', ""),
}  # fmt: skip


def test_the_certificates_that_are_corrupted_here_are_true():
    assert agreed(small()) == "proved"
    assert agreed(refuted()) == "refuted"


@pytest.mark.parametrize("name", CORRUPTED)
def test_a_corrupted_certificate_is_refused_by_both_checkers(name):
    data = small()
    CORRUPTED[name](data)
    assert data != small()
    assert agreed(data) == ""


REFUTED = {
    "no places": drop("places"),
    "one place": put("places", value=lambda places: places[:1]),
    "a place that is not in the body": put("places", 0, "weights", value=["2", "-1", "0", "0"]),
    "weights that sum to 2": put("places", 0, "weights", value=["1", "1", "0", "0"]),
    "weights for other corners": put("places", 0, "weights", value=["1", "0", "0"]),
    "corners that are far apart": put("places", 0, "weights", value=["0", "0", "1", "0"]),
    "a part that is not there": put("places", 0, "part", value=1),
    "a key too many": put("places", 0, "note", value=0),
    "another pair": put("boundary", value="hand, hook"),
    "a half-space": put("boundary", value="floor"),
    "a limit": put("boundary", value="q1.upper"),
    "no parts": put("parts", value={}),
    "a wrong part": put("parts", "hook", value=[[*range(7)]]),
    "a cell that is safe": put("weights", value=["1", "0", "0"]),
}


@pytest.mark.parametrize("name", REFUTED)
def test_a_corrupted_witness_refutes_nothing(name):
    data = refuted()
    REFUTED[name](data)
    if name == "corners that are far apart":
        data["places"][1]["weights"] = ["0", "0", "1", "0"]
    assert agreed(data) == ""


def test_a_keyhole_is_no_outline():
    """A hole that is joined to the outside by a slit: the slit's edges lie there and back."""
    outer, hole = (
        [[0.6, 0.4], [0.9, 0.4], [0.9, 0.7], [0.6, 0.7]],
        [[0.7, 0.5], [0.7, 0.6], [0.8, 0.5]],
    )
    loop = [*outer, outer[0], *hole, hole[0]]
    data = small()
    crate = "[[0.6, 0.4], [0.9, 0.4], [0.9, 0.7], [0.6, 0.7]]"
    data = with_robot(data, data["robot"].replace(crate, str(loop)))
    for found in (
        [[0, 1, 2, 3]],
        [[0, 1, 7], [1, 2, 7], [2, 6, 7], [2, 3, 6], [3, 0, 6], [0, 5, 6]],
    ):
        data["parts"]["crate"] = found
        data["proof"]["hand, crate"] = small()["proof"]["hand, crate"] * len(found)
        data["proof"]["upper arm, crate"] = small()["proof"]["upper arm, crate"] * len(found)
        assert agreed(data) == ""


def test_a_dropped_obstacle_is_another_robot():
    """Without its pillar the arm is safe in more places; who pins the robot sees that it is gone."""
    pillar = '[[obstacle]]\nname = "pillar"\ndisc = { at = [-0.3, 0.5, 0], radius = 0.1 }\n'
    without = arm().replace(pillar, "")
    answer = proving.certify(without, path((90, 30), (140, 0)))
    assert agreed(answer.text) == "proved"
    with pytest.raises(check.Refused, match="another robot"):
        CHECK(answer.text, check.digest(arm()))
    assert proving.certify(arm(), path((90, 30), (140, 0))).verdict == "refuted"


def test_the_answer_names_every_pair():
    said = CHECK(small_text()).said
    pairs = itertools.product(("upper arm", "hand"), ("crate", "pillar", "hook"))
    assert all(f"'{one}, {other}'" in said for one, other in pairs)
    assert "'hand, crate' with a margin of 0 m is violated" in CHECK(refuted_text()).said


# --- work -----------------------------------------------------------------------------------------


def many_corners():
    """Outlines of a thousand corners each, and a tree that names their features one by one."""
    data = small()
    x = [round(0.6 + 0.0003 * k, 4) for k in range(500)]
    top = [[a, 0.4 + (a - 0.7) ** 2] for a in x]
    loop = [*top, *[[a, 0.9] for a in x[::-1]]]
    crate = "[[0.6, 0.4], [0.9, 0.4], [0.9, 0.7], [0.6, 0.7]]"
    data = with_robot(data, data["robot"].replace(crate, str(loop)))
    count = len(loop)
    data["parts"]["crate"] = [[*range(count)]]
    tree = "a" * 119 + "".join(f"{k}." for k in range(120))
    data["proof"]["hand, crate"] = [tree] * 2
    return data


def many_pairs():
    """A thousand obstacles: too many pairs to be asked for."""
    disc = '[[obstacle]]\nname = "o{}"\ndisc = {{ at = [9, 9, 0], radius = 0.1 }}\n'
    data = small()
    return with_robot(data, data["robot"] + "".join(disc.format(k) for k in range(1900)))


@pytest.mark.parametrize("file", [many_corners, many_pairs])
def test_a_hostile_file_is_refused_in_bounded_time_and_memory(tmp_path, file):
    text = json.dumps(file())
    assert verdict_of(check_arb.verify, text) == ""
    (tmp_path / "hostile.json").write_text(text)

    def limits():
        resource.setrlimit(resource.RLIMIT_AS, (500_000_000, 500_000_000))
        resource.setrlimit(resource.RLIMIT_CPU, (30, 30))

    command = [sys.executable, str(FILE), str(tmp_path / "hostile.json")]
    done = subprocess.run(command, preexec_fn=limits, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (2, "")
    assert "fault of the checker" not in done.stdout
