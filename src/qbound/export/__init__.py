"""How do others read what was found? As JSON, tables, polygons and sentences.

- `formats`: texts and bytes of files; `document`: regions as JSON; `configuration`: what is known
  of one configuration;
- `polygons`: rings through the arcs of a region; `outlines`: these as CSV, GeoJSON, NumPy arrays;
- `routes`, `samples`, `workspaces`: each of these as JSON, as a table or in words.
"""
