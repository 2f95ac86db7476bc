"""Results for other programs and for people: JSON, tables, polygons and sentences.

- `formats`: texts and bytes of files; `document`: regions as JSON; `configuration`: one
  configuration as JSON;
- `polygons`: rings through the arcs of a region; `outlines`: these as CSV, GeoJSON, NumPy arrays;
- `routes`, `samples`, `workspaces`: each of these as JSON, as a table or in words.
"""
