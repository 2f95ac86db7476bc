/* What Sphinx and MathJax put on every page of the book. */

declare const DOCUMENTATION_OPTIONS: { SHOW_SEARCH_SUMMARY: boolean };

interface Window {
  MathJax?: { startup?: { promise?: Promise<void> } };
}
