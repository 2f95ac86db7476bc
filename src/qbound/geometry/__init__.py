"""Geometry of points, polygons and meshes, without any robot.

- `polygon`: area, centroid, scaling; `convex`: simple polygons cut into convex parts, exactly;
- `distance`: how far convex cores are apart, or how deep they overlap, and where;
- `polylines`: curves in steps of a stated deviation;
- `solid_covers`, `mesh_covers`: few balls that cover a shape; `covering`: the proof that they do;
- `mesh_solids`: the solid that a mesh encloses; `inner_balls`: balls in it that touch its surface;
- `surface_distance`: a lower bound of the distance to a surface, from samples of it;
- `simplices`: segments, triangles and so on, and their halves; `bisection`: of many intervals;
- `arcs`: the gaps that intervals leave, on a line or round a circle.
"""
