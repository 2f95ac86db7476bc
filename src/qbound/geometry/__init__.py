"""Plane geometry that knows no robot: polygons, and curves as polylines."""
