"""What was found, as others read it: JSON, tables, polygons, sentences.

- `formats`: texts and bytes of files; `document`: regions as JSON;
- `polygons`: rings through the arcs of a region; `outlines`: these as CSV, GeoJSON, NumPy arrays;
- `routes`, `samples`, `workspaces`: each of these as JSON, as a table or in words.
"""
