"""Results for other programs and for people: JSON, tables, polygons and sentences.

- `formats`: texts and bytes of files; `document`: regions and workspaces as JSON;
  `configuration`: one configuration as JSON;
- `outlines`: rings through the arcs of a region, as CSV, GeoJSON, NumPy arrays, shapely;
- `routes`: paths as JSON, as a table or in words.
"""
