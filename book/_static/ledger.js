// The table of the ledger: without this script all of it is there; with it one can filter, sort and search.

const controls = document.querySelector(".ledger-controls");
const bodies = [...document.querySelectorAll(".ledger tbody")];
const bySeverity = bodies.filter((body) => body instanceof HTMLTableSectionElement);
const byPlace = [...bySeverity].sort(
  (one, other) => Number(one.dataset.place) - Number(other.dataset.place),
);
const entries = bySeverity.flatMap((body) => [...body.rows]);
const CHOICES = ["likeliest", "favourable", "severity", "kind"];

/** @type {(text: string) => string[]} */
const wordsOf = (text) => text.toLowerCase().split(/\s+/).filter(Boolean);

/** @type {(row: HTMLTableRowElement, wanted: FormData) => boolean} */
function isWanted(row, wanted) {
  const text = row.textContent.toLowerCase();
  return (
    CHOICES.every((name) => !wanted.get(name) || row.dataset[name] === wanted.get(name)) &&
    wordsOf(`${wanted.get("words")}`).every((word) => text.includes(word))
  );
}

/** @type {(form: HTMLFormElement) => void} */
function filterLedger(form) {
  const wanted = new FormData(form);
  for (const row of entries) row.hidden = !isWanted(row, wanted);
  const order = wanted.get("order") === "severity" ? bySeverity : byPlace;
  order[0]?.parentElement?.append(...order);
  const shown = entries.filter((row) => !row.hidden).length;
  const count = form.querySelector(".ledger-count");
  if (count) count.textContent = `${shown} of ${entries.length} entries`;
}

// A link to an entry shows it, whatever the filter says.
/** @type {(form: HTMLFormElement) => void} */
function showTarget(form) {
  const row = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (row?.hidden) {
    form.reset();
    row.scrollIntoView();
  }
}

if (controls instanceof HTMLFormElement) {
  controls.hidden = false;
  controls.addEventListener("input", () => filterLedger(controls));
  controls.addEventListener("reset", () => setTimeout(() => filterLedger(controls)));
  controls.addEventListener("submit", (event) => event.preventDefault());
  window.addEventListener("hashchange", () => showTarget(controls));
  filterLedger(controls);
}
