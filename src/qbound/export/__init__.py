"""Regions as others read them: polygons of a stated deviation."""
