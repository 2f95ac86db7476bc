"""What is true of points and lines, whatever they stand for? Geometry that knows no robot.

- `polygon`: area, centroid, scaling; `convex`: simple polygons cut into convex parts, exactly;
- `polylines`: curves in steps of a stated deviation;
- `simplices`: segments, triangles and so on, and their halves; `bisection`: of many intervals.
"""
