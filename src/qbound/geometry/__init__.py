"""What is true of points and lines, whatever they stand for? Geometry that knows no robot.

- `polygon`: area, centroid, scaling; `convex`: simple polygons cut into convex parts, exactly;
- `distance`: how far convex cores are apart, or how deep they overlap, and where;
- `polylines`: curves in steps of a stated deviation;
- `simplices`: segments, triangles and so on, and their halves; `bisection`: of many intervals.
"""
