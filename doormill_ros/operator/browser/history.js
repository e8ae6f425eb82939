// The table of ended runs: the last ones as they come, or what is found among all that are kept.
import { ENGLISH, byId, errorText, language, text, write } from "./language.js";

const PAUSE = 250; // ms after the last key
const SHOWN = 50;
let recent = [];
let told = "";
let number = 0;
let timer = 0;

export const outcome = (run) => text(`outcome.${run.came_to}`, { code: run.error_code });

const sought = () => byId("search").value.trim();

function cell(row, words) {
  row.insertCell().textContent = words;
}

// The headline of its error, and under it the English report.
function report(row, run) {
  const made = row.insertCell();
  const said = errorText(run.error_code);
  if (said) made.append(Object.assign(document.createElement("p"), { textContent: said.headline }));
  made.append(Object.assign(document.createElement("p"), { textContent: run.message, lang: ENGLISH }));
}

function showRuns(runs) {
  const rows = runs.map((run) => {
    const row = document.createElement("tr");
    row.className = run.success ? "milled" : "refused";
    cell(row, new Date(run.ended * 1000).toLocaleString(language(), { dateStyle: "short", timeStyle: "short" }));
    cell(row, run.door_id);
    cell(row, outcome(run));
    report(row, run);
    return row;
  });
  byId("history").replaceChildren(...rows);
}

function countOf({ found, kept, whole, runs }) {
  const count = text(found > runs.length ? "history.found.more" : "history.found", { found, kept, shown: runs.length });
  return whole ? count : `${count}; ${text("history.found.part")}`;
}

const question = () => new URLSearchParams({ search: sought(), language: language() });

function pointExport() {
  byId("export").href = sought() ? `/history.csv?${question()}` : "/history.csv";
}

async function search() {
  number += 1;
  const mine = number;
  told = "";
  pointExport();
  if (!sought()) {
    showRuns(recent);
    write("found", "");
    return;
  }
  told = changed();
  try {
    const response = await fetch(`/history?${question()}&limit=${SHOWN}`);
    if (!response.ok) throw new Error(response.status);
    const answer = await response.json();
    if (mine !== number) return; // something else is sought meanwhile
    showRuns(answer.runs);
    write("found", countOf(answer));
  } catch {
    if (mine !== number) return;
    told = ""; // the next view asks again
    write("found", text("history.lost"));
  }
}

// What a search depends on beside its words.
const changed = () => JSON.stringify([language(), recent.map((run) => run.run_id)]);

export function showHistory(history) {
  recent = history;
  if (!sought()) showRuns(recent);
  else if (told !== changed()) search();
}

byId("search").addEventListener("input", () => {
  pointExport();
  clearTimeout(timer);
  timer = setTimeout(search, PAUSE);
});
