// The table of the ledger: without this script all of it is there; with it one can filter and search.

const ledger = document.querySelector(".ledger");
const controls = ledger?.querySelector(".ledger-controls");
const entries = [...(ledger?.querySelectorAll("tbody tr") ?? [])];

const wordsOf = (text) => text.toLowerCase().split(/\s+/).filter(Boolean);

function isWanted(row) {
  const { verdict, kind, words } = controls.elements;
  const text = row.textContent.toLowerCase();
  return (
    (!verdict.value || row.dataset.verdict === verdict.value) &&
    (!kind.value || row.dataset.kind === kind.value) &&
    wordsOf(words.value).every((word) => text.includes(word))
  );
}

function filterLedger() {
  let shown = 0;
  for (const row of entries) {
    row.hidden = !isWanted(row);
    shown += !row.hidden;
  }
  controls.querySelector(".ledger-count").value = `${shown} of ${entries.length} entries`;
}

// A link to an entry shows it, whatever the filter says.
function showTarget() {
  const row = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (row?.hidden) {
    controls.reset();
    row.scrollIntoView();
  }
}

if (controls) {
  controls.hidden = false;
  controls.addEventListener("input", filterLedger);
  controls.addEventListener("reset", () => setTimeout(filterLedger));
  controls.addEventListener("submit", (event) => event.preventDefault());
  window.addEventListener("hashchange", showTarget);
  filterLedger();
}
