// The door in hand, or the last one: its features, which of them is milled, and how far each is off.
import { byId, size, text, write } from "./language.js";

const GAP = 160; // mm between two faces
const ROOM = 12; // mm between a feature and whose it is
const HALF_LETTER = 22; // mm
const TICK = 1000; // ms
const NONE = "–";
const FACES = ["hinge_edge", "front", "lock_edge"];
const MEASURED = ["within", "beyond", "measured", "not_measured"];
let drawn = null;
let begun = {}; // by robot: when this page saw it begin with which run

function made(parent, kind, attributes, words) {
  const element = document.createElementNS(byId("drawing").namespaceURI, kind);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  if (words) element.textContent = words;
  parent.append(element);
  return element;
}

// A robot tells that it mills, not what: while it does, the plan's clock tells features before, in and after work.
function shareNow(share) {
  const since = begun[share.robot || 0];
  if (share.came_to !== "in_work" || share.end <= 0 || !since) return share.came_to;
  const passed = (Date.now() - since.at) / 1000;
  if (passed < share.begin) return "planned";
  return passed < share.end ? "in_work" : "milled";
}

// Of one robot a feature is a share of its own.
const sharesOf = (feature) => (feature.shares.length ? feature.shares : [feature]);

function cameTo(feature) {
  if (MEASURED.includes(feature.came_to)) return feature.came_to;
  const now = [...new Set(sharesOf(feature).map(shareNow))];
  if (now.length === 1) return now[0];
  if (now.includes("in_work")) return "in_work";
  return now.includes("milled") ? "half_milled" : "not_milled";
}

const numbers = (feature) => feature.shares.map((share) => share.robot).join(" + ");

function told(feature, came) {
  const words = text(`came.${came}`);
  if (!feature.shares.length) return text("drawing.feature", { feature: feature.name, came: words });
  return text("drawing.feature.robots", { feature: feature.name, robots: numbers(feature), came: words });
}

function drawFaces(door) {
  const drawing = byId("drawing");
  drawing.replaceChildren();
  const widths = { hinge_edge: door.thickness, front: door.width, lock_edge: door.thickness };
  let left = GAP;
  for (const face of FACES) {
    const frame = { class: "wood", x: left, y: GAP, width: widths[face], height: door.height };
    made(drawing, "rect", frame);
    made(drawing, "text", { x: left + widths[face] / 2, y: GAP - 30, "text-anchor": "middle" }, text(`face.${face}`));
    for (const feature of door.features.filter((one) => one.face === face)) {
      const points = feature.outline.map(([u, v]) => `${left + u},${GAP + door.height - v}`).join(" ");
      const came = cameTo(feature);
      const polygon = made(drawing, "polygon", { class: feature.hidden ? `${came} hidden` : came, points });
      made(polygon, "title", {}, told(feature, came));
      if (feature.shares.length) {
        const across = feature.outline.map(([u]) => u);
        const middle = feature.outline.reduce((sum, [, v]) => sum + v, 0) / feature.outline.length;
        // On the wood where there is room, else beside the edge.
        const far = face === "front" && Math.min(...across) > widths[face] / 2;
        const beside = far ? Math.min(...across) - ROOM : (face === "front" ? Math.max(...across) : widths[face]) + ROOM;
        const at = { class: face === "front" ? "on-wood" : "beside", "text-anchor": far ? "end" : "start", x: left + beside,
          y: GAP + door.height - middle + HALF_LETTER };
        made(drawing, "text", at, numbers(feature));
      }
    }
    left += widths[face] + GAP;
  }
  drawing.setAttribute("viewBox", `0 0 ${left} ${door.height + 2 * GAP}`);
}

function listFeatures(door) {
  const rows = door.features.map((feature) => {
    const row = document.createElement("tr");
    const came = cameTo(feature);
    row.className = came;
    const error = feature.deviation < 0 ? NONE : size(feature.deviation);
    const allowed = feature.tolerance > 0 ? size(feature.tolerance) : NONE;
    for (const words of [feature.name, text(`came.${came}`), error, allowed]) row.insertCell().textContent = words;
    if (feature.shares.length) {
      const whose = Object.assign(document.createElement("span"), { className: "whose" });
      whose.textContent = text("feature.robots", { robots: numbers(feature) });
      row.cells[0].append(whose);
    }
    return row;
  });
  byId("drawing-features").replaceChildren(...rows);
}

// How many of the features, or halves of them, each of two robots has milled.
function listRobots(door) {
  const shares = door.features.flatMap((feature) => feature.shares);
  const robots = [...new Set(shares.map((share) => share.robot))].sort();
  byId("drawing-whose").hidden = !robots.length;
  byId("drawing-robots").replaceChildren(...robots.map((robot) => {
    const own = shares.filter((share) => share.robot === robot);
    const milled = own.filter((share) => shareNow(share) === "milled").length;
    const words = text("drawing.robot", { robot, milled, features: own.length });
    const item = document.createElement("li");
    const bar = Object.assign(document.createElement("progress"), { max: own.length, value: milled, ariaLabel: words });
    item.append(words, bar);
    return item;
  }));
}

function clocked(door) {
  const working = new Set(door.features.flatMap(sharesOf)
    .filter((share) => share.came_to === "in_work").map((share) => share.robot || 0));
  const kept = Object.entries(begun).filter(([robot, { run }]) => working.has(Number(robot)) && run === door.run_id);
  begun = Object.fromEntries(kept);
  for (const robot of working) begun[robot] ||= { run: door.run_id, at: Date.now() };
  return working.size > 0;
}

export function showDoor(door) {
  drawn = door;
  byId("door-drawing").hidden = !door;
  if (!door) return;
  const inWork = clocked(door);
  byId("drawing-hint").hidden = !inWork || !door.features.flatMap(sharesOf).some((share) => share.end > 0);
  write("drawing-title", text("drawing", { door: door.door_id }));
  drawFaces(door);
  listFeatures(door);
  listRobots(door);
}

setInterval(() => { if (drawn && Object.keys(begun).length) showDoor(drawn); }, TICK);
