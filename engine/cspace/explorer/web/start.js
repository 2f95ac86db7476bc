/* The explorer's own page: all controls, and a link that restores the view. */

{
  const [main, data] = ["main", "#robot-data"].map((name) => document.querySelector(name));
  if (!(main instanceof HTMLElement && data)) throw new Error("The page has no place or no data.");
  window.explorer = window.qboundEngine.mount(main, JSON.parse(data.textContent), { page: true });
}
