// What this copy of the book has for running pages: nothing, until `python3 run.py live` adds it.
window.rerunFiles = null;
