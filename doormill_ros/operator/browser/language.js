// The page's own texts in the reader's language. What a node says in its own words is English and marked so.
export const ENGLISH = "en";
const LANGUAGES = [ENGLISH, "de", "nb"];
const SAME = { no: "nb", nn: "nb" };
const KEPT = "language";
const AGAIN = 2000; // ms
export const UNNAMED = 1; // an error without a code of its own
let spoken = ENGLISH;
let texts = {};
let errors = {}; // headline and advice by error code
let last = null;

export const byId = (id) => document.getElementById(id);
export const language = () => spoken;
export const known = (key) => Object.hasOwn(texts, key);

// A text with its values; what a value holds is not looked at again.
export const text = (key, values = {}) => texts[key].replace(/\{(\w+)\}/g, (_, name) => values[name]);

export function write(id, words, lang = "") {
  const element = byId(id);
  if (element.textContent !== words) element.textContent = words;
  if (lang) element.lang = lang;
  else element.removeAttribute("lang");
}

// Words made of data, or the monitor's own where those are wanted or there are no data.
export function say(id, own, made, whole = (words) => words) {
  const english = language() === ENGLISH;
  const words = (!english && made) || own;
  write(id, words ? whole(words) : "", english || made ? "" : ENGLISH);
  byId(id).hidden = !words;
}

// What an error means to the operator and what to do; null for 0, which is none.
export function errorText(code) {
  if (!code) return null;
  return Object.hasOwn(errors, code) ? errors[code] : errors[UNNAMED];
}

export function size(metres) {
  if (metres < 0) return text("size.unknown");
  const value = (1000 * metres).toFixed(2);
  return text("size", { value: spoken === ENGLISH ? value : value.replace(".", ",") });
}

// The language that was chosen here before, or the first of the browser's that the page speaks.
export function wanted() {
  let kept = null;
  try {
    kept = localStorage.getItem(KEPT);
  } catch {
    // Where nothing may be kept the browser's languages decide.
  }
  const asked = [kept, ...navigator.languages].map((tag) => (tag || "").toLowerCase().split("-")[0]);
  return asked.map((code) => SAME[code] || code).find((code) => LANGUAGES.includes(code)) || ENGLISH;
}

async function load(name) {
  for (;;) {
    try {
      const answer = await fetch(`/texts/${name}.json`);
      if (answer.ok) return await answer.json();
    } catch {
      // The cell may be starting.
    }
    await new Promise((resume) => { setTimeout(resume, AGAIN); });
  }
}

export async function speak(code) {
  last = code;
  const [found, said] = await Promise.all([load(code), load(`errors/${code}`)]);
  if (last !== code) return; // another one was chosen meanwhile
  [spoken, texts] = [code, found];
  errors = Object.fromEntries(Object.entries(said).flatMap(([codes, words]) => codes.split(" ").map((one) => [one, words])));
  document.documentElement.lang = code;
  document.title = text("title");
  byId("language").value = code;
  document.querySelectorAll("[data-text]").forEach((element) => { element.textContent = text(element.dataset.text); });
  document.querySelectorAll("[data-label]").forEach((element) => { element.ariaLabel = text(element.dataset.label); });
  document.querySelectorAll("[data-alt]").forEach((element) => { element.alt = text(element.dataset.alt); });
  try {
    localStorage.setItem(KEPT, code);
  } catch {
    // It is asked for again next time.
  }
}
