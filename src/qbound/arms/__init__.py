"""What of arms with more than two joints? Where they can go, and why not.

- `separations`: ranges of one joint that something blocks, whatever the other joints do;
- `search`: a path, looked for in doubles; `why`: separations, a proved path, a paving, in this
  order; `answers`: what was found, in sentences and as JSON.
"""
