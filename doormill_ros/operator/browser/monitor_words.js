// What the model's monitor found, said in the reader's language from the data of its verdict.
import { known, size, text } from "./language.js";

const VERDICTS = ["consistent", "explained", "partly_explained", "unexplained"];
export const named = (cause) => (known(`cause.${cause}`) ? text(`cause.${cause}`) : cause.replaceAll("_", " "));

export function placed(where) {
  const [, kind, number] = where.match(/^(joint|link) (\d+)$/) || [];
  if (kind) return text(`place.${kind}`, { number });
  return known(`place.${where}`) ? text(`place.${where}`) : text("place.other", { place: where });
}

function fault({ cause, where, course, from_run, from_door }) {
  const name = text("cause.at", { cause: named(cause), place: placed(where) });
  const run = text(from_door ? "run.door" : "run", { run: from_run, door: from_door });
  return text(known(`course.${course}`) ? `course.${course}` : "course.always", { cause: name, run });
}

// The verdict in a sentence; empty where there is none, or of a kind that this page does not know.
export function verdictSentence(found) {
  if (!VERDICTS.includes(found.verdict)) return "";
  const doors = text(found.questioned === 1 ? "doors.one" : "doors.many", { count: found.questioned });
  const said = text(`verdict.${found.verdict}`, { doors, causes: found.causes.map(fault).join(text("and")) });
  const outlook = text(found.proposed ? "outlook.better" : "outlook.best");
  if (found.expected < 0) return text("verdict.no_outlook", { said, outlook });
  return text("verdict.outlook", { said, size: size(found.expected), outlook });
}

function step({ step: kind, cause, other, by, points, feature, recipe }) {
  const pair = { cause: named(cause), other: named(other) };
  if (kind === "points") return text("next.points", { ...pair, points, feature, recipe });
  if (kind !== "check") return text(`next.${kind}`);
  return text("next.check", { ...pair, check: text(by ? `check.${by}` : "next.recipes") });
}

// What to measure next; empty where that is not known as data, or of a kind that this page does not know.
export function nextSentence(found) {
  const every = found.next_steps.every((one) => known(`next.${one.step}`) && (!one.by || known(`check.${one.by}`)));
  return every ? found.next_steps.map(step).join("; ") : "";
}

// Why no door is milled.
export function stopReason({ expected, limit, version, proposed, expected_proposed: left }) {
  if (!(limit > 0 && expected > limit)) return text("stop.other");
  const repair = text("stop.repair");
  const would = { version: proposed, left: size(left), repair };
  let helps = repair;
  if (proposed && left >= 0) helps = text(left <= limit ? "stop.accept" : "stop.too_much", would);
  return text("stop", { expected: size(expected), limit: size(limit), version, helps });
}

// What is wrong with the monitor itself, by its error's code.
export const trouble = (code) => (known(`error.${code}`) ? text(`error.${code}`) : text("error.other", { code }));
