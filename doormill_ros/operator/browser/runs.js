// The part of the page on the bags of runs alone. In English the monitor speaks in its own words.
import { ENGLISH, byId, language, say, text } from "./language.js";
import { trouble } from "./monitor_words.js";
import { runsNext, runsSentence } from "./runs_words.js";

export function showRuns(found) {
  byId("runs").hidden = !(found && (found.sentence || found.message));
  if (byId("runs").hidden) return;
  say("runs-verdict", found.sentence, runsSentence(found));
  byId("runs-verdict").className = found.changes.length ? "changed" : "";
  say("runs-next", found.next_measurement, runsNext(found), (next) => text("measure", { next }));
  say("runs-message", found.message, found.error_code ? trouble(found.error_code) : "");
  byId("runs-hint").hidden = language() === ENGLISH || !found.left_aside.length;
  byId("runs-left").replaceChildren(...found.left_aside.map((words) => {
    const item = document.createElement("li");
    item.textContent = words;
    return item;
  }));
}
