"""What is asked of a workspace: its areas, the postures of places, a passage between two poses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from numpy.typing import ArrayLike

from qbound.region import Region
from qbound.workspace.areas import Workspace, find_workspace, overlap
from qbound.workspace.passage import Passage, find_passage
from qbound.workspace.planar import Posture, planar_arm


@dataclass(frozen=True, eq=False)
class PlaceReport:
    """A place of the plane and what reaches it.

    Attributes
    ----------
    place : tuple of two float
        Length.
    postures : list of (Posture, int or None)
        With the component of each; None where it is not safe.
    safe : int
        Number of safe postures: 0, 1 or 2.
    """

    place: tuple[float, float]
    postures: list[tuple[Posture, int | None]]
    safe: int


@dataclass(frozen=True, eq=False)
class WorkspaceReport:
    """The workspace of the home component with what was asked of it.

    Attributes
    ----------
    workspace : Workspace
    safe_and_unsafe : float
        Area of the places that are reached both safely and unsafely; length squared.
    places : list of PlaceReport
    passage : Passage or None
        None where none was asked for.
    """

    workspace: Workspace
    safe_and_unsafe: float
    places: list[PlaceReport]
    passage: Passage | None

    @property
    def all_safe(self) -> bool:
        """Whether every place is reached safely and the passage, if any, is possible."""
        return all(at.safe for at in self.places) and (not self.passage or self.passage.possible)


def workspace_report(
    region: Region,
    places: Sequence[tuple[float, float]] = (),
    poses: Sequence[ArrayLike] = (),
) -> WorkspaceReport:
    """Find the workspace of the home component, postures of places, a passage between two poses.

    Parameters
    ----------
    places : sequence of (float, float)
        In the plane of motion; length.
    poses : sequence of two array_like, shape (2,), or none
        Start and goal of a passage; rad or length.

    Raises
    ------
    NoHomeError
        If the home pose is in no component.
    ValueError
        If the tool leaves its plane: a ``NoPlanarWorkspaceError``.
    """
    robot, problem = region.robot, region.problem
    arm, home = planar_arm(robot, problem.held), robot.home[list(problem.joints)]
    one, other = (robot.joints[j].limits for j in problem.joints)
    workspace = find_workspace(arm, problem, home)
    return WorkspaceReport(
        workspace,
        overlap(arm, problem, home, (one, other)),
        [PlaceReport(at, workspace.postures(at), workspace.safe_postures(at)) for at in places],
        find_passage(workspace.region, *poses) if poses else None,
    )
