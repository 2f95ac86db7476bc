"""``cspace certify``: prove or refute that configurations are feasible, and write the proof."""

import argparse
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from cspace import check
from cspace.arms.links import SPHERES_ONLY, on_spheres, unchecked_lines
from cspace.boundary.evaluator import violated
from cspace.cli import chosen
from cspace.cli.terminal import progress_line, say, write_all
from cspace.cli.values import box, held
from cspace.geometry import polygon
from cspace.model.robot import Robot
from cspace.model.robotfile import parse_robot
from cspace.proofs.certificates import certify as proofs
from cspace.proofs.certificates import statements
from cspace.region import find_region
from cspace.units import counted, joint_text, limited_joints, margin_text, parse_length

STEPS = 1000
"""Of the progress that is shown."""

STATUS = {"proved": 0, "refuted": 1, "undecided": 3}


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "certify",
        help="prove that every configuration of a set is feasible",
        description="Prove that every configuration of a set keeps every boundary, or refute it.\n"
        "Certificates take at most 7 joints and 2,000 boundaries.\n"
        "\n"
        "A CSV file has a line for each configuration, in order: a value for each joint, with\n"
        "commas between, as the robot file orders the joints, in its units or with units of their\n"
        "own (20,-45 or 20deg,-0.8rad). Its first line may name the columns (q1,q2 or\n"
        "q1_rad,q2_rad, as traverse --csv writes them). A polygon takes a robot of two joints and\n"
        "three lines or more; its last corner joins the first.",
        epilog="exit status: 0 proved, 1 refuted, 3 undecided; 2 bad input\n"
        "needs cspace[proofs]\n"
        "example: cspace certify minervabot-v2 --scale 0.96 -o cert.json",
    )
    chosen.add_robot(parser)
    sets = parser.add_mutually_exclusive_group()
    sets.add_argument(
        "--scale", metavar="S", help="the polygon of home's vertices, scaled (default 1)"
    )
    sets.add_argument("--region", action="store_true", help="home's region but for --inset")
    sets.add_argument("--box", nargs="+", metavar="q1=-20deg..30deg", help="all joints in ranges")
    sets.add_argument("--path", metavar="CSV", help="straight segments from line to line")
    sets.add_argument("--polygon", metavar="CSV", help="all inside a polygon, either sense")
    sets.add_argument(
        "--largest-scale", action="store_true", help="a proof and a witness around the largest"
    )
    parser.add_argument(
        "--margin",
        default="0",
        metavar="LENGTH",
        help="to keep beside: 5mm, or a plain number of the robot file's unit (default 0)",
    )
    parser.add_argument(
        "--inset",
        metavar="LENGTH",
        help="of --region: leave out what is nearer to a boundary than this, 5mm (default: 1 %% of"
        " the reach)",
    )
    parser.add_argument("--slice", nargs="+", default=[], metavar="q3=20deg", help="hold joints")
    parser.add_argument("-o", "--output", metavar="FILE", help="write the certificate")
    chosen.add_memory(parser)
    parser.set_defaults(run=run, endings=("json",))


def run(options: argparse.Namespace) -> int:
    """Prove or refute the statement; return 0 if proved, 1 if refuted, 3 if undecided."""
    robot = parse_robot(*chosen.proved_text(options.robot))
    if proofs.no_certificate(robot):
        raise ValueError(proofs.no_certificate(robot))
    subject = proofs.Subject(robot)
    chosen.refuse_memory(options, chosen.region_bytes(robot), chosen.FEWER)
    margin = statements.length_decimal(robot, "--margin", options.margin)
    if Fraction(margin) < 0:
        raise ValueError(f"--margin {margin}: a length of 0 or more is wanted")
    if options.largest_scale:
        if options.margin != "0" or options.slice:
            raise ValueError(
                "--largest-scale: for the robot as it is, without --margin and --slice"
            )
        return _say_bracket(robot, proofs.bracket_scale(subject), options)
    asked = None if options.region else statement(robot, options, margin)
    shown = progress_line("searching for a proof", STEPS)

    def progress(part: float) -> None:
        shown(int(part * STEPS))

    if asked is None:
        inset, values = _inset(robot, options), held(robot, options.slice)
        answer = proofs.certify_region(subject, inset, margin, values, progress)
    else:
        answer = proofs.certify(subject, asked, progress=progress)
    shown(STEPS)
    written = _write(options, answer)
    if options.output != "-" or not answer.text:
        said = (
            proofs.summed_up(answer.said, check.read(answer.text)[1])
            if answer.text
            else answer.said
        )
        say(*proofs.folded(said), *proofs.certificate_lines(robot, answer), *written)
        if answer.witness is not None and on_spheres(robot, [answer.witness.boundary]):
            say(*proofs.folded(SPHERES_ONLY))
        if answer.verdict != "proved":
            say(*_instead(robot, options, answer))
        say(*unchecked_lines(robot))
    return STATUS[answer.verdict]


def _write(options: argparse.Namespace, answer: proofs.Certificate) -> list[str]:
    """Write the certificate, if a file is named; return a sentence about the file."""
    if not answer.text or options.output is None:
        return []
    write_all([(options.output, answer.text)])
    return [f"written: {options.output}"]


def statement(robot: Robot, options: argparse.Namespace, margin: str) -> statements.Statement:
    """Return the statement that the options describe, except for a region."""
    values = held(robot, options.slice)
    if options.inset is not None:
        raise ValueError("--inset: only --region is proved but for an inset")
    if options.box:
        return statements.box(*box(robot, options.box), margin)
    if options.path:
        return statements.path(statements.read_points(robot, options.path), margin)
    if options.polygon:
        loop = statements.anticlockwise(
            statements.opened(statements.read_points(robot, options.polygon))
        )
        return statements.filled([loop], margin)
    scale = float(statements.as_decimal("--scale", options.scale or "1"))
    return statements.home_polygon(robot, scale, margin, values)


def _instead(
    robot: Robot, options: argparse.Namespace, answer: proofs.Certificate
) -> Iterator[str]:
    """Return advice after an answer that is not "proved"."""
    undecided = answer.verdict == "undecided"
    if undecided and answer.leaves:
        yield f"cells that were found feasible: {answer.leaves}"
    if options.region:
        inset = f"{_inset(robot, options):g} {robot.length_unit}"
        yield f"a set with a larger --inset than {inset} takes less work"
    elif options.box or options.path or options.polygon:
        if undecided:
            yield "a smaller set takes less work: cut this one into parts"
    else:
        region = find_region(robot, held(robot, options.slice))
        loops = region.home_component.loops if region.has_home else ()
        if len(loops) > 1:
            holes = counted(len(loops) - 1, "hole")
            yield f"home's component has {holes}, which the polygon of its vertices covers"
        yield "a lower --scale asks for less; --region leaves nothing out but a strip"


def _inset(robot: Robot, options: argparse.Namespace) -> float:
    """Return the inset of `--region`, a length."""
    if options.inset is None:
        return statements.usual_inset(robot)
    return parse_length(options.inset, robot.length_unit, "--inset")


def _say_bracket(robot: Robot, bracket: proofs.Bracket, options: argparse.Namespace) -> int:
    """Print both scales; the file is the proof of the lower one."""
    (safe, proof), refutation = bracket.safe, bracket.unsafe[1]
    proved = proof is not None and proof.verdict == "proved"
    if proof is not None and proved:
        written = _write(options, proof)
        if options.output != "-":
            say(f"scale {safe}: proved", *proofs.certificate_lines(robot, proof), *written)
    if options.output != "-":
        say(*_other_scales(robot, bracket), *unchecked_lines(robot))
    if refutation is None:  # every scale is feasible, or no infeasible one is known
        return 0 if proved and not bracket.undecided[0] else 3
    return 0 if proved and refutation.verdict == "refuted" else 3


def _other_scales(robot: Robot, bracket: proofs.Bracket) -> Iterator[str]:
    """Yield for each scale what is not proved: no such scale was found, or it is undecided."""
    (safe, proof), (unsafe, refutation) = bracket.safe, bracket.unsafe
    scale, left = bracket.undecided
    centre = "" if proof is not None else _of_centre(robot)
    if proof is None:
        yield f"no scale is proved{centre}; try --region, or a --box"
    elif proof.verdict != "proved":
        yield from proofs.folded(f"scale {safe}: undecided: {proof.said}")
    if scale:
        yield from proofs.folded(f"halving stopped at scale {scale}, undecided: {left}")
    if refutation is not None and refutation.verdict != "refuted":
        yield from proofs.folded(f"scale {unsafe}: undecided: {refutation.said}")
    elif refutation is not None and not centre:
        yield f"scale {unsafe}: refuted"
        yield from proofs.certificate_lines(robot, refutation)


def _of_centre(robot: Robot) -> str:
    """Return what the centre of all scales violates; empty if the centre is feasible."""
    centre = polygon.centroid(statements.home_vertices(robot))
    names = [
        f"{name} by {margin_text(robot, name, -margin, limited_joints(robot))}"
        for name, margin in violated(robot, centre)
    ]
    if not names:
        return ""
    where = f"the centroid of home's vertices is infeasible itself, at {joint_text(robot, centre)}"
    return f": {where}: it violates {', '.join(names)}"
