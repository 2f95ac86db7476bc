// The table of the ledger: without this script all of it is there; with it one can filter and search.

const controls = document.querySelector(".ledger-controls");
const rowsOfTable = [...document.querySelectorAll(".ledger tbody tr")];
const entries = rowsOfTable.filter((row) => row instanceof HTMLTableRowElement);

/** @type {(text: string) => string[]} */
const wordsOf = (text) => text.toLowerCase().split(/\s+/).filter(Boolean);

/** @type {(row: HTMLTableRowElement, wanted: FormData) => boolean} */
function isWanted(row, wanted) {
  const [verdict, kind, words] = ["verdict", "kind", "words"].map((name) => `${wanted.get(name)}`);
  const text = row.textContent.toLowerCase();
  return (
    (!verdict || row.dataset.verdict === verdict) &&
    (!kind || row.dataset.kind === kind) &&
    wordsOf(words).every((word) => text.includes(word))
  );
}

/** @type {(form: HTMLFormElement) => void} */
function filterLedger(form) {
  const wanted = new FormData(form);
  for (const row of entries) row.hidden = !isWanted(row, wanted);
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
