"""Geometry of points, polygons and meshes, without any robot.

- `polygon`: area, centroid, scaling; polylines: steps of a stated deviation, crossings;
- `convex`: simple polygons cut into convex parts, exactly;
- `solid_covers`: few balls that cover a solid or a mesh; `covering`: the proof that they do;
- `triangulation`: polygons with holes cut into triangles, in whole numbers;
- `isosurface`: the triangles of a level set on a grid, by marching cubes;
- `mesh_solids`: the solid that a mesh encloses, the distance to its surface, balls in it;
- `simplices`: segments, triangles and so on, and their halves;
- `arcs`: the gaps that intervals leave, on a line or round a circle; bisection of many intervals.
"""
