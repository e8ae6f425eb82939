// Everything shown goes through textContent, so that no text of a recipe or a node becomes markup.
import { outcome, showHistory } from "./history.js";
import { ENGLISH, UNNAMED, byId, errorText, known, language, speak, text, wanted, write } from "./language.js";
import { showDoor } from "./door.js";
import { refusedModelOrder, showModel, shown as model } from "./model.js";
import { stopReason } from "./monitor_words.js";
import { nodeName, showFaults, showReport } from "./reports.js";
import { showRuns } from "./runs.js";

const SILENCE = 15000; // ms without a sign of life
let heard = 0;
let token = "";
let view = null;
let ageAt = null; // when the state began, by the clock of the page, which nobody sets

function showPicture(picture) {
  const image = byId("picture");
  image.hidden = !picture;
  if (!picture) return;
  const { caption, key, values } = picture;
  write("caption", key ? text(`caption.${key}`, values) : caption, key ? "" : ENGLISH);
  if (image.dataset.number === String(picture.number)) return;
  image.dataset.number = picture.number;
  image.src = `/picture/${picture.number}`;
}

// In English what nodes report stands in it in their own words, else what their data and codes say.
function nextStep() {
  const { key, values } = view.step;
  if (language() === ENGLISH) return text(`step.${key}`, values);
  if (key === "stopped" && view.model) return text("step.stopped", { message: stopReason(view.model) });
  if (key !== "fault") return text(`step.${key}`, values);
  const fault = view.faults.find((one) => one.node === values.node);
  return text("step.fault", { node: nodeName(values.node), message: errorText(fault.error_code || UNNAMED).headline });
}

// What both of two robots do, in one sentence.
const pairSentence = () => view.robots.map(({ robot, does }) => (known(`pair.${does}`) ? text(`pair.${does}`, { robot }) : does)).join("; ");

function stateSentence() {
  const { key, door, before, ended } = view.situation;
  const name = before ? text("before.name", { door: before }) : "";
  const values = ended ? { door, before: text(`before.${ended}`, { name }) } : {};
  const own = known(`situation.${key}`) ? text(`situation.${key}`, values) : key;
  const words = view.robots.length ? pairSentence() : own;
  const said = errorText(view.state_code);
  return said ? text("state.error", { words, headline: said.headline }) : words;
}

// The handshake's state; in English in the bridge's own words, which stand below it in other languages.
function showState() {
  const own = view.state ? `${view.state}: ${view.state_reason}` : "";
  const english = language() === ENGLISH;
  if (own) write("state", english ? own : stateSentence());
  else write("state", text("state.unknown"));
  write("state-words", english ? "" : own, ENGLISH);
  byId("state-words").hidden = english || !own;
}

function show(told) {
  view = told;
  // A refusal waits for the operator too, but nobody shall take it for a success from afar.
  byId("step").className = view.refusal ? `${view.urgency} refused` : view.urgency;
  write("next-step", nextStep());
  showReport("refusal", view.refusal_code, view.refusal);
  byId("refusal").hidden = !view.refusal;
  showState();
  ageAt = view.state && view.state_age !== null ? performance.now() - 1000 * view.state_age : null;
  showAge();
  write("door", view.run_id ? text("door.stage", { door: view.door_id, stage: stage() }) : text("door.none"));
  const last = view.history[0];
  write("last", last ? text("last.run", { door: last.door_id, outcome: outcome(last) }) : text("last.none"));
  byId("progress").hidden = !view.run_id;
  byId("progress").value = view.progress;
  showReport("notice", view.notice_code, view.notice);
  showFaults(view.faults);
  showPicture(view.picture);
  showDoor(view.drawing);
  showHistory(view.history);
  byId("control").hidden = !view.control;
  showModel(view.model, view.control);
  showRuns(view.runs);
}

const stage = () => (known(`stage.${view.stage}`) ? text(`stage.${view.stage}`) : view.stage);

// How long the state named above has lasted, by the clock of the cell.
function showAge() {
  const passed = ageAt === null ? -1 : Math.max(0, Math.floor((performance.now() - ageAt) / 1000));
  const values = { minutes: Math.floor(passed / 60), seconds: passed % 60 };
  write("since", passed < 0 ? text("state.unknown") : text("state.age", values));
}

function alive() {
  heard = Date.now();
  byId("lost").hidden = true;
}

function connect() {
  const source = new EventSource("/events");
  alive();
  source.addEventListener("message", (event) => { alive(); show(JSON.parse(event.data)); });
  source.addEventListener("alive", alive);
  source.addEventListener("error", () => {
    byId("lost").hidden = false;
    // The browser tries again by itself unless the answer told it not to.
    if (source.readyState === EventSource.CLOSED) setTimeout(connect, 2000);
  });
}

// Why the cell refused an order: the model's have sentences of their own.
function refusedOrder(code, forModel) {
  const said = errorText(Number(code));
  const other = said ? `${said.headline}. ${said.advice}` : text("refused.409");
  return forModel ? refusedModelOrder(code, other) : other;
}

// What came of an order in the reader's language, and the cell's own words where those say more; in English them alone.
async function answerTo(response, done, wrong, forModel) {
  const answer = await response.json();
  const own = answer.message || (typeof answer.detail === "string" ? answer.detail : "");
  // What is missing or too long the page says itself; the cell's own words are for other programs.
  if (answer.fields) return [text(wrong)];
  if (response.status === 422) return own && language() === ENGLISH ? [own] : [text(wrong), own];
  if (language() === ENGLISH) return [own];
  if (response.ok) return [done];
  if (response.status === 409) return [refusedOrder(response.headers.get("Error-Code"), forModel), own];
  const key = [401, 403, 429].includes(response.status) ? response.status : "other";
  return [text(`refused.${key}`, { wait: response.headers.get("Retry-After") })];
}

function tell(id, words, own = "") {
  write(id, words);
  if (!own) return;
  const english = document.createElement("span");
  [english.lang, english.textContent] = [ENGLISH, `(${own})`];
  byId(id).append(" ", english);
}

async function order(path, body, done, told = "answer", buttons = ["mill", "cancel"], wrong = "wrong.door") {
  buttons.forEach((id) => { byId(id).disabled = true; });
  try {
    // An Authorization header: the token is in no address and no history.
    const response = await fetch(path, {
      method: "POST",
      headers: { "Authorization": `Bearer ${token}`, "Content-Type": "application/json" },
      body: JSON.stringify(body),
    });
    tell(told, ...await answerTo(response, done, wrong, told === "model-answer"));
  } catch {
    write(told, text("answer.lost"));
  } finally {
    buttons.forEach((id) => { byId(id).disabled = false; });
    if (model) showModel(model, true);
  }
}

function orderModel(name, version) {
  const body = { version, who: byId("who").value.trim(), why: byId("why").value.trim() };
  const done = text(`answer.${name}`, { version });
  order(`/control/${name}`, body, done, "model-answer", ["accept", "revert"], "wrong.order");
}

function mill() {
  const door = byId("wanted").value.trim();
  order("/control/mill", { door_id: door }, text("answer.mill", { door }));
}

let asked = null;

async function offerDoors() {
  const prefix = byId("wanted").value.trim();
  if (prefix === asked) return;
  asked = prefix;
  try {
    const response = await fetch(`/doors?prefix=${encodeURIComponent(prefix)}`);
    if (!response.ok || asked !== prefix) return;
    const options = (await response.json()).map((id) => {
      const option = document.createElement("option");
      option.value = id;
      return option;
    });
    byId("doors").replaceChildren(...options);
  } catch {
    asked = null; // typing works without the list
  }
}

byId("wanted").addEventListener("focus", offerDoors);
byId("wanted").addEventListener("input", offerDoors);
byId("token").addEventListener("input", (event) => { token = event.target.value.trim().replace(/[^!-~]/g, ""); });
byId("mill").addEventListener("click", mill);
byId("cancel").addEventListener("click", () => order("/control/cancel", {}, text("answer.cancel")));
byId("accept").addEventListener("click", () => orderModel("accept", model.proposed));
byId("revert").addEventListener("click", () => orderModel("revert", model.version));
byId("language").addEventListener("change", async (event) => {
  await speak(event.target.value);
  if (view) show(view);
});
setInterval(() => { if (view) showAge(); }, 1000);
setInterval(() => { if (Date.now() - heard > SILENCE) byId("lost").hidden = false; }, 1000);
await speak(wanted());
connect();
