/* The page of a surface. */

{
  const [main, data] = ["main", "#surface-data"].map((name) => document.querySelector(name));
  if (!(main instanceof HTMLElement && data)) throw new Error("The page has no place or no data.");
  const surface = showSurface(main, JSON.parse(data.textContent));
  window.surface = surface;
  answerFrame(() => surface?.redraw());
}
