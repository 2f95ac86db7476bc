"""Import of URDF: the chain of an arm and its links, covered by balls, as a robot.

- `xml`: files from strangers, read safely; `document`: a URDF, and an SRDF, as data;
- `tree`: the chain between two links, the links fixed to each, and poses in the chain;
- `covers`: the balls that cover a link, triangles of mesh files included;
- `arm`: the robot made from these, and its file.
"""
