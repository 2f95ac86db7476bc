"""``cspace import``: make a robot file of a URDF, its links covered by balls."""

import argparse
import math
from collections.abc import Iterable, Sequence
from typing import Any

from cspace.arms.fibres import by_links
from cspace.arms.links import SPHERES_ONLY, LostPoses, lost_poses
from cspace.boundary.evaluator import violated
from cspace.cli.terminal import deliver
from cspace.cli.values import span
from cspace.model.robotfile import RobotFileError
from cspace.units import parse_length
from cspace.urdf.arm import MANY_PAIRS, Imported, balls_inside, import_urdf, robot_text


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "import",
        help="make a robot file of a URDF, its links covered by balls",
        epilog="exit status: 0 imported, whether home is feasible or not; 2 bad input\n"
        "needs cspace[arms]\n"
        "example: cspace import ur5.urdf --srdf ur5.srdf --excess 0.01 -o ur5.toml",
    )
    parser.add_argument("urdf", help="a URDF, or a packaged one's name: ur5.urdf")
    parser.add_argument("--srdf", metavar="FILE", help="its disabled pairs, and the home pose")
    parser.add_argument("--from", dest="first", metavar="LINK", help="first link; default: root")
    parser.add_argument(
        "--to", dest="last", metavar="LINK", help="default: the link behind the most moving joints"
    )
    parser.add_argument(
        "--limits",
        nargs="+",
        action="extend",
        default=[],
        metavar="JOINT=-360deg..360deg",
        help="limits in place of the file's; plain numbers are rad or m",
    )
    parser.add_argument(
        "--excess",
        metavar="LENGTH",
        help="how far a ball may stick out of a link: 2cm, or a plain number of m; default: a tenth"
        f" of the size of each shape, or more of it so that there are {MANY_PAIRS:,} pairs at most",
    )
    parser.add_argument(
        "--clearance", default="0", metavar="LENGTH", help="kept by every pair: 1cm, or 0.01 (m)"
    )
    parser.add_argument("--home", metavar="STATE", help="a state of the SRDF; default: home, ready")
    parser.add_argument(
        "--neighbours",
        action="store_true",
        help="keep links apart, too, that one moving joint joins; default: only those that the SRDF"
        " names in enable_collisions",
    )
    parser.add_argument(
        "--package",
        nargs="+",
        action="extend",
        default=[],
        metavar="[NAME=]FOLDER",
        help="where package://NAME/... lies: a folder called NAME, or whose package.xml says NAME,"
        " or one that holds it; NAME=FOLDER if it is called otherwise; if links lead out of it,"
        " that folder, too",
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE", required=True, help="- is standard output"
    )
    parser.add_argument(
        "--force", action="store_true", help="replace a robot file that cspace did not make"
    )
    parser.set_defaults(run=run, endings=("toml",))


CURES = {
    "name it, or one that carries it": "--to LINK",
    "say where its package is": "--package",
    "name that folder as a package": "--package FOLDER",
    "name another state": "--home STATE",
    "without limits; give them for the import": "--limits JOINT=LOW..HIGH",
}
"""By words of an error, the option that they ask for."""


def run(options: argparse.Namespace) -> int:
    """Import the URDF; return 0 even if home is not feasible, which is printed."""
    excess = None if options.excess is None else parse_length(options.excess, "m", "--excess")
    try:
        imported = import_urdf(
            options.urdf,
            chain=(options.first, options.last),
            srdf=options.srdf,
            limits=limits(options.limits),
            excess=excess,
            packages=options.package,
            clearance=parse_length(options.clearance, "m", "--clearance"),
            home=options.home,
            neighbours=options.neighbours,
        )
    except RobotFileError as error:
        option = next((cure for words, cure in CURES.items() if words in str(error)), "")
        if not option:
            raise
        raise RobotFileError(f"{error} ({option})") from None
    lost = lost_poses(imported.robot, balls_inside(imported))
    deliver([(options.output, lambda: robot_text(imported))], _lines(imported, lost))
    return 0


def limits(texts: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Read ``elbow=-360deg..360deg``; return limits in rad or m, by the names of joints."""
    found: dict[str, tuple[float, float]] = {}
    for text in texts:
        name, _, ends_text = text.rpartition("=")
        try:
            low, high = span(ends_text)
            ends = _value(low), _value(high)
        except ValueError:
            ends = math.nan, math.nan
        if not name or not all(map(math.isfinite, ends)):
            raise ValueError(f"--limits {text}: wanted: JOINT=LOW..HIGH, as elbow=-180deg..180deg")
        if name in found:
            raise ValueError(f"--limits {text}: {name!r} has limits twice")
        found[name] = ends
    return found


def _value(text: str) -> float:
    degree = math.radians(1.0)
    for unit, scale in (("deg", degree), ("°", degree), ("rad", 1.0)):
        if text.strip().endswith(unit):
            return float(text.strip().removesuffix(unit)) * scale
    return parse_length(text, "m", "")


def _lines(imported: Imported, lost: LostPoses) -> Iterable[str]:
    """Yield lines about the new file, what it costs, and a home that is not feasible."""
    robot = imported.robot
    names = ", ".join(joint.name for joint in robot.joints)
    yield f"{robot.name}: from {imported.chain.frames[0]} to {imported.chain.tip}, joints {names}"
    yield f"{len(robot.points) - 1} balls, {len(robot.boundaries)} pairs"
    for note in imported.notes:
        yield f"{note[0].upper()}{note[1:]}."
    counts = (lost.refused, lost.meet, lost.refused - lost.meet)
    refused, meet, most = (f"{100 * count / lost.poses:g} %" for count in counts)
    yield (
        f"Of {lost.poses:,} random poses the balls refuse {refused}; in {meet} at least the links"
        f" meet themselves, so at most {most} are lost."
    )
    if touching := [name for name, _ in violated(robot, robot.home)]:
        yield f"The home pose is not feasible: {'; '.join(by_links(robot, touching))}."
        yield f"{SPHERES_ONLY[0].upper()}{SPHERES_ONLY[1:]}."
        yield "Ask for a smaller --excess, or disable links that always touch in the SRDF."
