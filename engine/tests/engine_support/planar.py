"""Arms between obstacles, as text of robot files: planar ones, and one of six joints."""

LENGTHS = (1.0, 0.8, 0.4)


def planar(*limits: str, unit: str = "deg", posts: str = "", slide: bool = False) -> str:
    """Write an arm of as many joints as there are limits, "" for none; the last one may slide."""
    names = ("shoulder", "elbow", "wrist")[: len(limits)]
    frames = ("base", "upper", "forearm", "hand")
    joints = ""
    for j, (name, limit) in enumerate(zip(names, limits, strict=True)):
        slides = slide and j == len(limits) - 1
        joints += f"""
[[joint]]
name = "{name}"
type = "{"prismatic" if slides else "revolute"}"
parent = "{frames[j]}"
frame = "{frames[j + 1]}"
origin = [{LENGTHS[j - 1] if j and not slides else 0}, 0, 0]
axis = {[1, 0, 0] if slides else [0, 0, 1]}
{f"limits = {limit}" if limit else ""}
"""
    tip = frames[len(limits)]
    home = ", ".join(f"{name} = 0" for name in names)
    return f"""schema = 1
name = "planar arm"
length_unit = "m"
angle_unit = "{unit}"
home = {{ {home} }}
tool = "tip"
{joints}
[[point]]
name = "tip"
frame = "{tip}"
at = [{LENGTHS[len(limits) - 1]}, 0, 0]
radius = 0.05
{posts}"""


def post(name: str, x: float, y: float, radius: float, point: str = "tip") -> str:
    """Write a ball in the plane that a point keeps away from."""
    return f"""
[[point]]
name = "{name}/ball"
frame = "base"
at = [{x}, {y}, 0]
radius = {radius}

[[boundary]]
name = "{name}"
type = "pair"
points = ["{name}/ball", "{point}"]
"""


def place(name: str, frame: str, x: float) -> str:
    """Write a point on a link."""
    return f'\n[[point]]\nname = "{name}"\nframe = "{frame}"\nat = [{x}, 0, 0]\nradius = 0.05\n'


def wall(name: str, x: float, y: float, offset: float, point: str = "tip") -> str:
    """Write a half-space that a point stays in."""
    return f"""
[[boundary]]
name = "{name}"
type = "half-space"
point = "{point}"
normal = [{x}, {y}, 0]
offset = {offset}
"""


def turning(unit: str = "deg") -> str:
    """One joint without limits, and two posts, one at the seam: neither way round is free."""
    return planar("", unit=unit, posts=post("east", 1, 0, 0.2) + post("west", -1, 0, 0.2))


def round_both(unit: str = "deg") -> str:
    """Two joints without limits; the forearm's tip cannot leave a strip, nor the elbow a side."""
    posts = place("knee", "upper", 1.0)
    posts += post("north", 0, 1, 0.25, "knee") + post("south", 0, -1, 0.25, "knee")
    return planar("", "", unit=unit, posts=posts + wall("east", -1, 0, -1.75))


def caged(unit: str = "deg") -> str:
    """Three joints in a cage: the arm cannot be stretched, so the elbow stays on its side."""
    limits = ["[-90, 90]", "[-170, 170]", "[-60, 60]"]
    if unit == "rad":
        limits = ["[-1.6, 1.6]", "[-3, 3]", "[-1, 1]"]
    posts = place("wrist ball", "forearm", 0.8)
    for name, x, y in (("front", -1, 0), ("left", 0, -1), ("right", 0, 1)):
        posts += wall(name, x, y, -1.2 if x else -1.1, "wrist ball")
    return planar(*limits, unit=unit, posts=posts + wall("tip front", -1, 0, -1.5))


def telescope() -> str:
    """A boom that turns without limits and slides: out of reach of a post it must be short."""
    posts = post("north", 0, 1.2, 0.9) + post("south", 0, -1.2, 0.9) + post("hub", 0, 0, 0.3)
    return planar("", "[-0.7, 0.2]", posts=posts, slide=True)
