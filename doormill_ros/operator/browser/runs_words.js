// What the bags of runs say alone, in the reader's language from the data of the monitor's verdict.
import { ENGLISH, language, text } from "./language.js";
import { named, placed } from "./monitor_words.js";

const VERDICTS = ["consistent", "explained", "partly_explained", "unexplained", "few"];
const FEWEST = 6; // runs from which on anything is called a change
const AXES = { y: "change.y", z: "change.z", rotation: "change.rotation" };
const counted = (count) => text(count === 1 ? "runs.one" : "runs.many", { count });

function decimal(value, sign) {
  const words = `${sign && !(value < 0 || Object.is(value, -0)) ? "+" : ""}${value.toFixed(2)}`;
  return language() === ENGLISH ? words : words.replace(".", ",");
}

function sized({ name, value, unit }) {
  const axis = Object.keys(AXES).find((one) => name.endsWith(`_${one}`));
  if (unit === "1" || !axis) return text("change.times", { value: decimal(value, false) });
  return text(AXES[axis], { value: decimal(1000 * value, true) });
}

// A link between controller and cell has the name of an arm's link that has no number.
const at = (where) => (where === "link" ? text("place.connection") : placed(where));

function changed({ cause, where, course, from_run: run, earliest, latest, said_sizes: sizes, tied_with: others }) {
  const name = text("cause.at", { cause: named(cause), place: at(where) });
  const change = sizes.length ? text("change.sizes", { cause: name, sizes: sizes.map(sized).join(", ") }) : name;
  const step = earliest === latest ? "change.step" : "change.between";
  const since = text(course === "drift" ? "change.drift" : step, { change, run, earliest, latest });
  return others.length ? text("change.tied", { change: since, others: others.map(named).join(text("or")) }) : since;
}

function sentenceOf({ verdict, changes, questioned }) {
  const runs = text("runs.alone", { runs: counted(questioned) });
  if (verdict === "few") return text("runs.few", { runs, count: FEWEST });
  if (!changes.length) return text(verdict === "consistent" ? "runs.quiet" : "runs.unnamed", { runs });
  const said = changes.map(changed).join(text("and"));
  return text(verdict === "explained" ? "runs.changed" : "runs.partly", { runs, changes: said });
}

// The verdict in a sentence; empty where there is none, or of a kind that this page does not know.
export function runsSentence(found) {
  if (!VERDICTS.includes(found.verdict)) return "";
  const said = sentenceOf(found);
  return found.left_aside.length ? text("runs.left", { said, count: found.left_aside.length }) : said;
}

// What to measure next; empty where nothing changed.
export function runsNext({ changes }) {
  if (!changes.length) return "";
  const step = changes.find((change) => change.course !== "drift");
  return step ? text("runs.next", { run: step.from_run }) : text("runs.next_drift");
}
