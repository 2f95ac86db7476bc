"""What does a URDF say of an arm? Its chain and its links, covered by balls, as a robot.

- `xml`: files of strangers, read safely; `document`, `shapes`: a URDF as data; `srdf`: an SRDF;
- `tree`: the chain between two links, what is fixed to each, and poses (`poses`) in it;
- `meshes`: triangles of files; `covers`: the balls that cover a link;
- `arm`: the robot of all this; `robot_text`: its file.
"""
