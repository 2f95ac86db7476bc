"""Import of URDF: the chain of an arm and its links, covered by balls, as a robot.

- `xml`: files from strangers, read safely; `document`, `shapes`: a URDF as data; `srdf`: an SRDF;
- `tree`: the chain between two links, the links fixed to each, and poses (`poses`) in the chain;
- `meshes`: triangles of files; `covers`: the balls that cover a link;
- `arm`: the robot made from these; `robot_text`: its file.
"""
